// SPDX-License-Identifier: Apache-2.0
// See bindings/benchmark/trace_file.c.
using System;
using System.Diagnostics;
using System.Globalization;
using System.IO;
using System.Runtime.InteropServices;
using Kiwami;

public static class TraceFile {
  public static void Main(string[] arguments) {
    byte[] bytes = File.ReadAllBytes(arguments[1]);
    var rays = new Ray[bytes.Length / Marshal.SizeOf<Ray>()];
    GCHandle pin = GCHandle.Alloc(rays, GCHandleType.Pinned);
    Marshal.Copy(bytes, 0, pin.AddrOfPinnedObject(), bytes.Length);
    pin.Free();
    using (var device = new Device())
    using (Scene scene = Scene.Load(device, arguments[0], true, true)) {
      var hits = new Hit[rays.Length];
      for (int round = int.Parse(arguments[2]); round > 0; --round) {
        Stopwatch watch = Stopwatch.StartNew();
        scene.ClosestHit(rays, hits);
        Console.WriteLine(watch.Elapsed.TotalSeconds.ToString(CultureInfo.InvariantCulture));
      }
    }
  }
}
