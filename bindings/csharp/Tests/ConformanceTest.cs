// SPDX-License-Identifier: Apache-2.0
// The answers that every binding must give, to the bit.
using System;
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
  static readonly string Vectors =
      File.ReadAllText(Environment.GetEnvironmentVariable("KIWAMI_VECTORS"));
  static readonly float[] Corners = { 0, 0, 0, 1, 0, 0, 0, 1, 0 };

  /// Notes that features were found right, for the table of the documents.
  static void Note(params string[] features) {
    string path = Environment.GetEnvironmentVariable("KIWAMI_FEATURES");
    if (path != null) File.AppendAllLines(path, features);
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
    string folder = Path.GetDirectoryName(Environment.GetEnvironmentVariable("KIWAMI_VECTORS"));
    string saved = Path.GetTempFileName();
    scene.Save(saved);
    Hit[] expected = scene.ClosestHit(rays);
    foreach (string path in new[] { saved, Path.Combine(folder, words.Word()) }) {
      foreach (bool map in new[] { false, true }) {
        using (Scene loaded = Scene.Load(device, path, map, map)) {
          CollectionAssert.AreEqual(expected, loaded.ClosestHit(rays));
        }
      }
    }
    File.Delete(saved);
    Assert.Throws<KiwamiException>(() => Scene.Load(device, Path.Combine(folder, "vectors.txt")));
    Note("files");
  }

  static int CheckScene(Words words, Device device) {
    using (var scene = new Scene(device)) {
      words.Word();
      string word = words.Word();
      for (; word == "mesh"; word = words.Word()) {
        uint mask = words.Int();
        var vertices = new float[3 * words.Int()];
        var triangles = new uint[3 * words.Int()];
        for (int i = 0; i < vertices.Length; ++i) vertices[i] = words.Float();
        for (int i = 0; i < triangles.Length; ++i) triangles[i] = words.Int();
        scene.AddMesh(vertices, triangles, mask);
      }
      Assert.AreEqual("rays", word);
      var rays = new Ray[words.Int()];
      for (int i = 0; i < rays.Length; ++i) rays[i] = words.Ray();
      scene.Commit();
      Assert.AreEqual("closest_hit", words.Word());
      foreach (Hit hit in scene.ClosestHit(rays)) words.ExpectHit(hit);
      Assert.AreEqual("any_hit", words.Word());
      foreach (bool occluded in scene.AnyHit(rays)) Assert.AreEqual(words.Int() == 1, occluded);
      for (word = words.Word(); word == "multi_hit"; word = words.Word()) {
        CheckMultiHit(words, scene, rays);
      }
      if (word == "file") {
        CheckFile(words, device, scene, rays);
        word = words.Word();
      }
      Assert.AreEqual("end", word);
      Note("closest hit", "any hit", "multi hit", "counts");
      return rays.Length;
    }
  }

  [TestCase(Isa.Auto)]
  [TestCase(Isa.Scalar)]
  public void AnswersAreTheSameToTheBit(Isa isa) {
    using (var device = new Device(isa, 0, true)) {
      var words = new Words(Vectors);
      Assert.AreEqual("kiwami-conformance", words.Word());
      Assert.AreEqual("1", words.Word());
      int compared = 0;
      while (words.Word() == "scene") compared += CheckScene(words, device);
      Assert.Greater(compared, 100);
    }
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
