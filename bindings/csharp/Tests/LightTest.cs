// SPDX-License-Identifier: Apache-2.0
// Sets of lights against the answers that every binding must give.
using System;
using System.IO;
using System.Linq;
using System.Runtime.InteropServices;
using Kiwami;
using NUnit.Framework;

[TestFixture]
public class LightTest {
  /// Structs of words, as they lie in memory.
  static T[] Records<T>(Words words, uint count) where T : struct {
    var records = new T[count];
    GCHandle handle = GCHandle.Alloc(records, GCHandleType.Pinned);
    int[] bits = words.Ints((uint)(count * Marshal.SizeOf<T>() / 4)).Select(i => (int)i).ToArray();
    Marshal.Copy(bits, 0, handle.AddrOfPinnedObject(), bits.Length);
    handle.Free();
    return records;
  }

  /// Plays a set of lights; returns how many choices were compared.
  static int Play(Words words, Device device) {
    int compared = 0;
    LightReceiver[] receivers = null;
    LightChoice[] choices = null;
    using (var lights = new LightTree(device, words.Int())) {
      for (string word = words.Word(); word != "end"; word = words.Word()) {
        switch (word) {
          case "light":
            lights.AddLights(Records<Light>(words, words.Int()));
            break;
          case "light_mesh": {
            bool isTwoSided = words.Int() != 0;
            float radiance = words.Float();
            uint[] counts = words.Ints(2);
            float[] vertices = words.Floats(3 * counts[0]);
            lights.AddMesh(vertices, words.Ints(3 * counts[1]), radiance, isTwoSided);
            break;
          }
          case "powers": {
            uint first = words.Int();
            lights.SetPowers(first, words.Floats(words.Int()));
            break;
          }
          case "commit":
            lights.Commit();
            break;
          case "refit":
            lights.Refit();
            break;
          case "receivers":
            receivers = Records<LightReceiver>(words, words.Int());
            break;
          case "choices":
            choices = lights.Sample(receivers);
            CollectionAssert.AreEqual(Records<LightChoice>(words, (uint)choices.Length), choices);
            compared += choices.Length;
            break;
          default:
            Assert.AreEqual("pdf", word);
            foreach (float each in lights.Pdf(receivers, choices)) {
              Assert.AreEqual(words.Int(), BitConverter.ToUInt32(BitConverter.GetBytes(each), 0));
            }
            break;
        }
      }
    }
    return compared;
  }

  [TestCase(Isa.Auto)]
  [TestCase(Isa.Scalar)]
  public void ChoicesAreTheSameToTheBit(Isa isa) {
    using (var device = new Device(isa, 0, true)) {
      var words = new Words(ConformanceTest.Read("lights"));
      Assert.AreEqual("kiwami-conformance", words.Word());
      Assert.AreEqual("1", words.Word());
      int compared = 0;
      while (!words.IsAtEnd && words.Word() == "lights") compared += Play(words, device);
      Assert.Greater(compared, 100);
      ConformanceTest.Note("many lights");
    }
  }

  [Test]
  public void BadLightsAreExceptions() {
    Assert.AreEqual(96, Marshal.SizeOf<Light>());
    Assert.AreEqual(56, Marshal.SizeOf<LightReceiver>());
    Assert.AreEqual(24, Marshal.SizeOf<LightChoice>());
    var device = new Device();
    var receivers = new[] { new LightReceiver { LinkMask = ulong.MaxValue } };
    Assert.Throws<KiwamiException>(() => new LightTree(device, 3));
    var lights = new LightTree(device);
    device.Dispose();
    Assert.Throws<KiwamiException>(() => lights.Sample(receivers));
    Assert.Throws<KiwamiException>(() => lights.AddLights(new[] { new Light { Kind = (LightKind)99 } }));
    Assert.Throws<KiwamiException>(() => lights.SetPowers(0, new float[1]));
    Assert.Throws<KiwamiException>(() => lights.AddMesh(new float[3], new uint[] { 0, 0, 1 }));
    Assert.Throws<ArgumentException>(() => lights.AddMesh(new float[4], new uint[3]));
    Assert.Throws<ArgumentException>(() => lights.Pdf(receivers, new LightChoice[0]));
    lights.AddLights(new[] { new Light { Point0 = new Vector(0, 0, 1), Power = 2, UserId = 7,
                                         LinkMask = ulong.MaxValue } });
    lights.Commit();
    Assert.AreEqual(7, lights.Sample(receivers)[0].UserId);
    lights.Dispose();
    Assert.Throws<ObjectDisposedException>(() => lights.Commit());
  }
}
