// SPDX-License-Identifier: Apache-2.0
// A program ends although the library's threads have called it, and nothing was disposed of. The
// runners of tests end by other means, so this is a program of its own.
using System;
using System.Linq;
using Kiwami;

sealed class Planes : IUserGeometry {
  public void Bounds(uint first, Box[] boxes) {
    for (int i = 0; i < boxes.Length; ++i) {
      boxes[i] = new Box { LowerX = -1, LowerY = -1, UpperX = 1, UpperY = 1 };
    }
  }

  public void Intersect(Intersection asked) {
    foreach (uint id in asked.PrimitiveIds) asked.Add(new UserHit { T = 1, PrimitiveId = id });
  }
}

static class ExitTest {
  static Scene scene;

  static int Main() {
    scene = new Scene(new Device());
    scene.AddUserGeometry(4, new Planes());
    scene.Commit(fraction => false);
    Ray[] rays = Enumerable.Repeat(new Ray(0, 0, -1, 0, 0, 1), 20000).ToArray();
    bool[] occluded = scene.AnyHit(rays, candidate => FilterAnswer.Accept);
    return occluded.All(each => each) ? 0 : 1;
  }
}
