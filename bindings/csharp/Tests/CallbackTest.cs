// SPDX-License-Identifier: Apache-2.0
// Functions that the library calls back, and what they throw.
using System;
using System.Collections.Generic;
using System.Linq;
using System.Runtime.CompilerServices;
using System.Threading;
using Kiwami;
using NUnit.Framework;

/// Squares of side 2 across z = 0, 1, ...
public sealed class Squares : IUserGeometry {
  public bool ThrowsInBounds;
  public float ThrowsAt = -5;
  public int Adds = 1;

  public void Bounds(uint first, Box[] boxes) {
    if (ThrowsInBounds) throw new FormatException("no bounds");
    for (int i = 0; i < boxes.Length; ++i) {
      float z = first + i;
      boxes[i] = new Box { LowerX = -1, LowerY = -1, LowerZ = z, UpperX = 1, UpperY = 1, UpperZ = z };
    }
  }

  public void Intersect(Intersection asked) {
    Ray ray = asked.Ray;
    if (ray.OriginX == ThrowsAt) throw new FormatException("no hit at " + ThrowsAt);
    foreach (uint id in asked.PrimitiveIds) {
      float t = (id - ray.OriginZ) / ray.DirectionZ;
      float x = ray.OriginX + t * ray.DirectionX, y = ray.OriginY + t * ray.DirectionY;
      if (Math.Abs(x) > 1 || Math.Abs(y) > 1) continue;
      for (int i = 0; i < Adds; ++i) {
        asked.Add(new UserHit { T = t, U = x, V = y, NormalZ = -1, PrimitiveId = id });
      }
    }
  }
}

[TestFixture]
public class CallbackTest {
  static Ray RayAt(float x, float y) {
    return new Ray(x, y, -1, 0, 0, 1);
  }

  static Ray[] Rays(Ray ray) {
    return Enumerable.Repeat(ray, 3000).ToArray();
  }

  /// Eight triangles, one behind the other.
  static Scene Layers() {
    var scene = new Scene(new Device());
    var vertices = new List<float>();
    for (int z = 0; z < 8; ++z) vertices.AddRange(new float[] { -1, -1, z, 3, -1, z, -1, 3, z });
    scene.AddMesh(vertices.ToArray(), Enumerable.Range(0, 24).Select(i => (uint)i).ToArray());
    scene.Commit();
    return scene;
  }

  /// Each kind of trace call.
  static IEnumerable<TestDelegate> Calls(Scene scene, Ray[] rays, Filter filter = null) {
    yield return () => scene.ClosestHit(rays, filter);
    yield return () => scene.AnyHit(rays, filter);
    yield return () => scene.MultiHit(rays, 0, filter);
    yield return () => scene.CountHits(rays, filter);
  }

  [Test]
  public void FiltersAcceptRejectAndStop() {
    using (Scene scene = Layers()) {
      Ray[] rays = Rays(RayAt(0, 0));
      Filter odd = candidate => {
        if (candidate.Ray >= 3000 || candidate.InstancePath.Length != 0) throw new FormatException();
        return candidate.Hit.PrimitiveId % 2 == 1 ? FilterAnswer.Accept : FilterAnswer.Reject;
      };
      foreach (Hit hit in scene.ClosestHit(rays, odd)) Assert.AreEqual(1, hit.PrimitiveId);
      Assert.IsTrue(scene.AnyHit(rays, odd).All(each => each));
      Assert.IsFalse(scene.AnyHit(rays, candidate => FilterAnswer.Reject)[0]);
      Assert.IsTrue(scene.CountHits(rays, odd).All(each => each == 4));
      MultiHits found = scene.MultiHit(rays, 0, odd);
      CollectionAssert.AreEqual(new[] { 1, 3, 5, 7 }, found.Of(2999).Select(hit => hit.PrimitiveId));
      Assert.AreEqual(1, scene.CountHits(rays, candidate => FilterAnswer.AcceptAndStop)[0]);
      ConformanceTest.Note("filter callback");
    }
  }

  [Test]
  public void WhatAFilterThrowsIsTheInnerException() {
    using (Scene scene = Layers()) {
      Ray[] rays = Rays(RayAt(0, 0));
      Filter fail = candidate => { throw new FormatException("of the filter"); };
      foreach (TestDelegate call in Calls(scene, rays, fail)) {
        var error = Assert.Throws<KiwamiException>(call);
        Assert.IsInstanceOf<FormatException>(error.InnerException);
        StringAssert.EndsWith("of the filter", error.Message);
      }
      var bad = Assert.Throws<KiwamiException>(() => scene.AnyHit(rays, each => (FilterAnswer)7));
      Assert.IsNull(bad.InnerException);
      Assert.IsTrue(scene.AnyHit(rays)[0]);
    }
  }

  [Test]
  public void ProgressIsToldAndMayCancelOrThrow() {
    using (Scene scene = Layers()) {
      var fractions = new List<double>();
      scene.Commit(fraction => {
        fractions.Add(fraction);
        return false;
      });
      Assert.AreEqual(0, fractions.First());
      Assert.AreEqual(1, fractions.Last());
      CollectionAssert.IsOrdered(fractions);
      var cancelled = Assert.Throws<KiwamiException>(() => scene.Commit(fraction => true));
      Assert.IsNull(cancelled.InnerException);
      int calls = 0;
      var error = Assert.Throws<KiwamiException>(() => scene.Refit(fraction => {
        ++calls;
        throw new FormatException("no more");
      }));
      Assert.IsInstanceOf<FormatException>(error.InnerException);
      Assert.AreEqual(cancelled.Result, error.Result);
      // The function is gone, and what was committed before stays in use.
      Assert.IsTrue(scene.AnyHit(Rays(RayAt(0, 0)))[0]);
      scene.Commit();
      Assert.AreEqual(1, calls);
      ConformanceTest.Note("progress callback");
    }
  }

  /// In a call of its own, whose frame does not hold the geometry afterwards.
  [MethodImpl(MethodImplOptions.NoInlining)]
  static WeakReference AddSquares(Scene scene, uint mask) {
    var squares = new Squares();
    scene.AddUserGeometry(40, squares, mask);
    return new WeakReference(squares);
  }

  static void Collect() {
    var collector = new Thread(() => {
      GC.Collect();
      GC.WaitForPendingFinalizers();
    });
    collector.Start();
    collector.Join();
  }

  static Scene SceneOf(Squares squares) {
    var scene = new Scene(new Device());
    scene.AddUserGeometry(40, squares);
    return scene;
  }

  [Test]
  public void UserGeometriesAreBoundedAndIntersected() {
    var scene = new Scene(new Device());
    WeakReference squares = AddSquares(scene, 2);
    Collect();
    scene.Commit();
    Ray[] rays = Rays(RayAt(0.75f, -0.5f));
    var expected = new Hit { T = 1, U = 0.75f, V = -0.5f, NormalZ = -1, InstanceId = Hit.InvalidId };
    Assert.AreEqual(expected, scene.ClosestHit(rays).Last());
    Assert.AreEqual(40, scene.CountHits(rays)[0]);
    rays[0].Mask = 1;
    rays[1] = RayAt(1.5f, 0);
    CollectionAssert.AreEqual(new[] { false, false, true }, scene.AnyHit(rays).Take(3));
    Assert.IsTrue(squares.IsAlive);
    scene.Dispose();
    ConformanceTest.Note("user geometry callback");
  }

  [Test]
  public void UserGeometriesEndWithTheirScenes() {
    var scene = new Scene(new Device());
    WeakReference[] all = Enumerable.Range(0, 20).Select(_ => AddSquares(scene, 1)).ToArray();
    scene.Commit();
    Collect();
    Assert.IsTrue(all.All(each => each.IsAlive));
    scene.Dispose();
    Collect();
    // Mono takes what lies on the stack for references, so a few may seem to be in use.
    Assert.Less(all.Count(each => each.IsAlive), 5);
  }

  [Test]
  public void WhatAUserGeometryThrowsIsTheInnerException() {
    using (Scene scene = SceneOf(new Squares { ThrowsInBounds = true })) {
      var error = Assert.Throws<KiwamiException>(() => scene.Commit());
      StringAssert.EndsWith("no bounds", error.Message);
      error = Assert.Throws<KiwamiException>(() => scene.Commit(fraction => false));
      Assert.IsInstanceOf<FormatException>(error.InnerException);
    }
    using (Scene scene = SceneOf(new Squares { ThrowsAt = 0.5f })) {
      scene.Commit();
      Ray[] rays = Rays(RayAt(0.25f, 0));
      Assert.IsTrue(scene.AnyHit(rays).All(each => each));
      rays[2000] = RayAt(0.5f, 0);
      foreach (TestDelegate call in Calls(scene, rays)) {
        var error = Assert.Throws<KiwamiException>(call);
        Assert.AreEqual("no hit at 0.5", error.InnerException.Message);
      }
    }
    using (Scene scene = SceneOf(new Squares { Adds = 100 })) {
      scene.Commit();
      var error = Assert.Throws<KiwamiException>(() => scene.AnyHit(Rays(RayAt(0, 0))));
      Assert.IsInstanceOf<InvalidOperationException>(error.InnerException);
      Assert.Throws<KiwamiException>(() => scene.AddUserGeometry(1UL << 40, new Squares()));
      Assert.Throws<ArgumentNullException>(() => scene.AddUserGeometry(1, null));
    }
  }

  [Test]
  public void EachOfManyCallsHasItsOwnException() {
    using (Scene scene = SceneOf(new Squares { ThrowsAt = 0.5f })) {
      scene.Commit();
      var failed = new int[4];
      var threads = Enumerable.Range(0, failed.Length).Select(i => new Thread(() => {
        for (int round = 0; round < 100; ++round) {
          try {
            scene.ClosestHit(new[] { RayAt(i % 2 == 0 ? 0.5f : 0.25f, 0) });
          } catch (KiwamiException error) {
            if (error.InnerException is FormatException) ++failed[i];
          }
        }
      })).ToArray();
      foreach (Thread thread in threads) thread.Start();
      foreach (Thread thread in threads) thread.Join();
      CollectionAssert.AreEqual(new[] { 100, 0, 100, 0 }, failed);
    }
  }

  [Test]
  public void GeometriesOfWrongSizesAreExceptions() {
    using (Scene scene = Layers()) {
      Assert.Throws<ArgumentException>(() => scene.AddDiscs(new float[8], new float[3]));
      Assert.Throws<ArgumentException>(() => scene.AddMovingMesh(new float[9], 2, new uint[0]));
      Assert.Throws<KiwamiException>(() => scene.AddMovingMesh(new float[9], 0, new uint[0]));
      Assert.Throws<KiwamiException>(() => scene.AddInstances(new Scene[0], new float[12]));
      Assert.Throws<ArgumentException>(
          () => scene.AddInstances(new[] { scene }, new float[12], new uint[2]));
      Assert.Throws<ArgumentException>(() => scene.UpdateVertices(0, new float[3]));
      Assert.Throws<ArgumentException>(() => scene.UpdateVertices(1, new float[3]));
      scene.Commit();
    }
  }
}
