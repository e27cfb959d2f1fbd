// SPDX-License-Identifier: Apache-2.0
// The answers that every binding must give, to the bit.
using System;
using System.Collections.Generic;
using System.IO;
using System.Linq;
using System.Runtime.InteropServices;
using System.Threading;
using Kiwami;
using NUnit.Framework;

public sealed class Words {
  readonly string[] words;
  int next;

  public Words(string text) {
    words = text.Split((char[])null, StringSplitOptions.RemoveEmptyEntries);
  }
  public string Word() {
    return words[next++];
  }
  public ulong Number() {
    return ulong.Parse(Word());
  }
  public uint Int() {
    return (uint)Number();
  }
  public float Float() {
    return BitConverter.ToSingle(BitConverter.GetBytes(Int()), 0);
  }
  public float[] Floats(uint count) {
    return Enumerable.Range(0, (int)count).Select(_ => Float()).ToArray();
  }
  public uint[] Ints(uint count) {
    return Enumerable.Range(0, (int)count).Select(_ => Int()).ToArray();
  }
  public bool IsAtEnd {
    get { return next == words.Length; }
  }
  public Ray Ray() {
    return new Ray { OriginX = Float(), OriginY = Float(), OriginZ = Float(), TMin = Float(),
                     DirectionX = Float(), DirectionY = Float(), DirectionZ = Float(),
                     TMax = Float(), Time = Float(), Mask = Int(), Flags = Int(), Id = Int() };
  }
  public void ExpectHit(Hit hit) {
    foreach (float number in new[] { hit.T, hit.U, hit.V, hit.NormalX, hit.NormalY, hit.NormalZ }) {
      Assert.AreEqual(Int(), BitConverter.ToUInt32(BitConverter.GetBytes(number), 0));
    }
    foreach (uint id in new[] { hit.PrimitiveId, hit.GeometryId, hit.InstanceId }) {
      Assert.AreEqual(Int(), id);
    }
  }
}

[TestFixture]
public class ConformanceTest {
  static readonly string Folder =
      Path.GetDirectoryName(Environment.GetEnvironmentVariable("KIWAMI_VECTORS"));
  static readonly string Vectors = Read("vectors");
  static readonly float[] Corners = { 0, 0, 0, 1, 0, 0, 0, 1, 0 };

  /// Notes that features were found right, for the table of the documents.
  public static void Note(params string[] features) {
    string path = Environment.GetEnvironmentVariable("KIWAMI_FEATURES");
    if (path != null) File.AppendAllLines(path, features);
  }

  public static string Read(string name) {
    return File.ReadAllText(Path.Combine(Folder, name + ".txt"));
  }

  static void CheckMultiHit(Words words, Scene scene, Ray[] rays) {
    uint maxHits = words.Int();
    ulong total = words.Number();
    MultiHits found = scene.MultiHit(rays, maxHits);
    foreach (ulong offset in found.Offsets) Assert.AreEqual(words.Number(), offset);
    Assert.AreEqual(total, found.Hits.Length);
    foreach (Hit hit in found.Hits) words.ExpectHit(hit);
    uint[] counts = scene.CountHits(rays);
    for (int i = 0; i < counts.Length; ++i) {
      Assert.AreEqual(maxHits == 0 ? counts[i] : Math.Min(counts[i], maxHits), found.Of(i).Count);
    }
  }

  static void CheckFile(Words words, Device device, Scene scene, Ray[] rays) {
    string saved = Path.GetTempFileName();
    scene.Save(saved);
    Hit[] expected = scene.ClosestHit(rays);
    foreach (string path in new[] { saved, Path.Combine(Folder, words.Word()) }) {
      foreach (bool map in new[] { false, true }) {
        using (Scene loaded = Scene.Load(device, path, map, map)) {
          CollectionAssert.AreEqual(expected, loaded.ClosestHit(rays));
        }
      }
    }
    File.Delete(saved);
    Assert.Throws<KiwamiException>(() => Scene.Load(device, Path.Combine(Folder, "vectors.txt")));
    Note("files");
  }

  /// Adds a geometry of this kind, or says that it is none.
  static bool AddGeometry(string kind, Words words, Scene scene,
                          Dictionary<string, Scene> scenes) {
    switch (kind) {
      case "mesh": {
        uint[] head = words.Ints(3);
        float[] vertices = words.Floats(3 * head[1]);
        scene.AddMesh(vertices, words.Ints(3 * head[2]), head[0]);
        return true;
      }
      case "moving_mesh": {
        uint mask = words.Int(), steps = words.Int();
        float[] times = words.Floats(2);
        uint[] counts = words.Ints(2);
        float[] vertices = words.Floats(3 * steps * counts[0]);
        uint[] triangles = words.Ints(3 * counts[1]);
        scene.AddMovingMesh(vertices, steps, triangles, times[0], times[1], mask);
        return true;
      }
      case "spheres": {
        uint[] head = words.Ints(2);
        scene.AddSpheres(words.Floats(4 * head[1]), head[0]);
        return true;
      }
      case "discs": {
        uint[] head = words.Ints(2);
        float[] points = words.Floats(4 * head[1]);
        scene.AddDiscs(points, words.Floats(3 * head[1]), head[0]);
        return true;
      }
      case "curves": {
        uint[] head = words.Ints(3);
        float[] points = words.Floats(4 * head[1]);
        scene.AddCurves(points, words.Ints(head[2]), head[0]);
        return true;
      }
      case "instances":
        AddInstances(words, scene, scenes);
        return true;
      default:
        return false;
    }
  }

  static void AddInstances(Words words, Scene scene, Dictionary<string, Scene> scenes) {
    uint[] head = words.Ints(3);
    var shown = Enumerable.Range(0, (int)head[1]).Select(_ => scenes[words.Word()]).ToArray();
    var transforms = new List<float>();
    var indices = new uint[head[2]];
    var masks = new uint[head[2]];
    for (int i = 0; i < indices.Length; ++i) {
      indices[i] = words.Int();
      masks[i] = words.Int();
      transforms.AddRange(words.Floats(12));
    }
    scene.AddInstances(shown, transforms.ToArray(), indices, masks, head[0]);
  }

  /// Changes the scene by one statement, or says that it does not change it.
  static bool Change(string statement, Words words, Scene scene) {
    switch (statement) {
      case "commit":
        scene.Commit();
        return true;
      case "refit":
        scene.Refit();
        return true;
      case "vertices": {
        uint[] head = words.Ints(2);
        scene.UpdateVertices(head[0], words.Floats(3 * head[1]));
        return true;
      }
      case "enable": {
        uint[] head = words.Ints(2);
        scene.Enable(head[0], head[1] != 0);
        return true;
      }
      case "remove":
        scene.Remove(words.Int());
        return true;
      default:
        return false;
    }
  }

  static void Compare(string statement, Words words, Device device, Scene scene, Ray[] rays) {
    switch (statement) {
      case "closest_hit":
        foreach (Hit hit in scene.ClosestHit(rays)) words.ExpectHit(hit);
        break;
      case "any_hit":
        foreach (bool occluded in scene.AnyHit(rays)) Assert.AreEqual(words.Int() == 1, occluded);
        break;
      case "multi_hit":
        CheckMultiHit(words, scene, rays);
        break;
      case "file":
        CheckFile(words, device, scene, rays);
        break;
      default:
        Assert.Fail("the vectors have '" + statement + "'");
        break;
    }
  }

  /// Returns how many rays were compared.
  static int CheckScene(Words words, Device device, Dictionary<string, Scene> scenes) {
    var scene = new Scene(device);
    scenes[words.Word()] = scene;
    var rays = new Ray[0];
    int compared = 0;
    for (string statement = words.Word(); statement != "end"; statement = words.Word()) {
      if (statement == "rays") {
        rays = new Ray[words.Int()];
        for (int i = 0; i < rays.Length; ++i) rays[i] = words.Ray();
        compared += rays.Length;
      } else if (!AddGeometry(statement, words, scene, scenes) &&
                 !Change(statement, words, scene)) {
        Compare(statement, words, device, scene, rays);
      }
    }
    return compared;
  }

  static void CheckFileOfVectors(string name, Isa isa) {
    var scenes = new Dictionary<string, Scene>();
    using (var device = new Device(isa, 0, true)) {
      var words = new Words(Read(name));
      Assert.AreEqual("kiwami-conformance", words.Word());
      Assert.AreEqual("1", words.Word());
      int compared = 0;
      while (!words.IsAtEnd && words.Word() == "scene") {
        compared += CheckScene(words, device, scenes);
      }
      Assert.Greater(compared, 100);
      foreach (Scene each in scenes.Values) each.Dispose();
    }
  }

  [TestCase("vectors", "closest hit", "any hit", "multi hit", "counts")]
  [TestCase("shapes", "spheres, discs, curves")]
  [TestCase("moving_meshes", "moving meshes")]
  [TestCase("instances", "instances")]
  [TestCase("changes", "changes, refit")]
  public void AnswersAreTheSameToTheBit(string name, params string[] features) {
    CheckFileOfVectors(name, Isa.Auto);
    CheckFileOfVectors(name, Isa.Scalar);
    Note(features);
  }

  static void ExpectError(string name, TestDelegate call) {
    var error = Assert.Throws<KiwamiException>(call);
    string line = Vectors.Split('\n').First(each => each.StartsWith("error " + name + " "));
    Assert.AreEqual(line, "error " + name + " " + error.Result + " " + error.Message);
  }

  [Test]
  public void ErrorsAreTheSame() {
    using (var device = new Device())
    using (var scene = new Scene(device)) {
      ExpectError("index_beyond_vertices", () => scene.AddMesh(Corners, new uint[] { 0, 1, 3 }));
      ExpectError("unknown_geometry", () => scene.Remove(5));
      ExpectError("parameter_out_of_bounds", () => scene.SetParameter(4, 1000));
      ExpectError("not_committed", () => scene.ClosestHit(new Ray[1]));
      Note("errors");
    }
  }

  [Test]
  public void MisuseIsAnException() {
    var device = new Device();
    var scene = new Scene(device);
    device.Dispose();
    Assert.Throws<ArgumentException>(() => scene.AddMesh(new float[4], new uint[3]));
    scene.Commit();
    Assert.Throws<ArgumentException>(() => scene.ClosestHit(new Ray[2], new Hit[1]));
    Assert.AreEqual(0, scene.ClosestHit(new Ray[0]).Length);
    scene.Dispose();
    Assert.Throws<ObjectDisposedException>(() => scene.Commit());
  }

  [Test]
  public void LayoutsAreThoseOfC() {
    Assert.AreEqual(48, Marshal.SizeOf<Ray>());
    Assert.AreEqual(36, Marshal.SizeOf<Hit>());
  }

  [Test]
  public void ManyThreadsTraceOneScene() {
    var scene = new Scene(new Device());
    scene.AddMesh(Corners, new uint[] { 0, 1, 2 });
    scene.Commit();
    var rays = Enumerable.Range(0, 100).Select(i => new Ray(i / 50f, 0.1f, -1, 0, 0, 1)).ToArray();
    Hit[] expected = scene.ClosestHit(rays);
    var found = new Hit[4][];
    var threads = Enumerable.Range(0, 4)
                      .Select(i => new Thread(() => found[i] = scene.ClosestHit(rays)))
                      .ToArray();
    foreach (Thread thread in threads) thread.Start();
    foreach (Thread thread in threads) thread.Join();
    foreach (Hit[] hits in found) CollectionAssert.AreEqual(expected, hits);
  }
}
