// SPDX-License-Identifier: Apache-2.0
// Scenes: what is done with them as a whole. What they hold is in Geometries.cs.
using System;
using System.Runtime.InteropServices;
using System.Text;
using Kiwami.Interop;

namespace Kiwami {

/// <summary>The hits of many rays: those of ray i are Hits[Offsets[i]] to Hits[Offsets[i + 1] - 1].
/// </summary>
public sealed class MultiHits {
  public ulong[] Offsets { get; internal set; }
  public Hit[] Hits { get; internal set; }

  /// <summary>The hits of one ray, by rising distance.</summary>
  public ArraySegment<Hit> Of(int ray) {
    return new ArraySegment<Hit>(Hits, (int)Offsets[ray], (int)(Offsets[ray + 1] - Offsets[ray]));
  }
}

/// <summary>Meshes under one acceleration structure. Changes take effect with Commit. A committed
/// scene can be traced from any number of threads.</summary>
public sealed partial class Scene : SafeHandle {
  readonly IntPtr device;

  public Scene(Device device) : base(IntPtr.Zero, true) {
    this.device = device.DangerousGetHandle();
    var made = new IntPtr[1];
    using (var target = new Pin(made)) {
      Check(Native.kiwami_scene_create(this.device, target.Address));
    }
    Native.kiwami_device_retain(this.device);
    SetHandle(made[0]);
    GC.KeepAlive(device);
  }

  Scene(IntPtr device, IntPtr scene) : base(IntPtr.Zero, true) {
    this.device = device;
    Native.kiwami_device_retain(device);
    SetHandle(scene);
  }

  public override bool IsInvalid {
    get { return handle == IntPtr.Zero; }
  }
  protected override void Dispose(bool disposing) {
    if (disposing) {
      foreach (Geometry each in attached.Values) each.Dispose();
    }
    base.Dispose(disposing);
  }
  protected override bool ReleaseHandle() {
    Native.kiwami_scene_release(handle);
    Native.kiwami_device_release(device);
    return true;
  }

  void Check(int result) {
    KiwamiException.Check(result, device);
  }

  /// <summary>As Call, for what may run callbacks: those of user geometries, and others of its own
  /// (or null), whose exception goes first.</summary>
  int Run(RunningCallback own, Func<IntPtr, int> call) {
    using (var running = UserErrors.Begin()) {
      try {
        return Call(call);
      } catch (KiwamiException error) {
        Exception cause = own == null ? null : own.Thrown;
        // Other results have other reasons than user geometries.
        if (cause == null && error.Result == Native.KIWAMI_ERROR_CALLBACK) cause = running.First;
        if (cause == null) throw;
        throw error.With(cause);
      }
    }
  }

  /// <summary>A trace call, with the address of its query, which may be 0.</summary>
  int Trace(Filter filter, Func<IntPtr, IntPtr, int> call) {
    if (filter == null) return Run(null, scene => call(scene, IntPtr.Zero));
    using (var running = new RunningFilter(filter))
    using (var query = new Pin(new kiwami_query[1])) {
      Native.kiwami_query_init(query.Address, (UIntPtr)kiwami_query.Size);
      var fields = Marshal.PtrToStructure<kiwami_query>(query.Address);
      fields.filter = RunningFilter.Function;
      fields.filter_user = running.User;
      Marshal.StructureToPtr(fields, query.Address, false);
      return Run(running, scene => call(scene, query.Address));
    }
  }

  /// <summary>The scene's address for the length of one call. Disposed scenes are an error.</summary>
  int Call(Func<IntPtr, int> call) {
    bool isHeld = false;
    CallingThread.Enter();
    try {
      DangerousAddRef(ref isHeld);
      int result = call(handle);
      if (result != Native.KIWAMI_ERROR_CAPACITY) Check(result);
      return result;
    } finally {
      CallingThread.Leave();
      if (isHeld) DangerousRelease();
    }
  }

  /// <summary>Sets one of KIWAMI_PARAMETER_* of scene.h.</summary>
  public void SetParameter(uint parameter, double value) {
    Call(scene => Native.kiwami_scene_set_parameter(scene, parameter, value));
  }

  /// <summary>Builds the acceleration structure of what the scene holds now.
  /// progress: is told a fraction from 0 to 1, which never falls, from any thread, never from two at
  /// a time. Where it returns true, the commit ends with KIWAMI_ERROR_CANCELLED; what it throws ends
  /// the commit, too, and is the InnerException. What was committed before stays in use.</summary>
  public void Commit(Func<double, bool> progress = null) {
    Build(Native.kiwami_scene_commit, progress);
  }

  /// <summary>As Commit, but keeps the tree where only vertices moved: quicker to make, and, the
  /// further they moved, slower to trace.</summary>
  public void Refit(Func<double, bool> progress = null) {
    Build(Native.kiwami_scene_refit, progress);
  }

  void Build(Func<IntPtr, int> build, Func<double, bool> progress) {
    if (progress == null) {
      Run(null, build);
      return;
    }
    using (var running = new RunningProgress(progress)) {
      Run(running, scene => {
        Native.kiwami_scene_set_progress(scene, RunningProgress.Function, running.User);
        int result = build(scene);
        Native.kiwami_scene_set_progress(scene, IntPtr.Zero, IntPtr.Zero);
        return result;
      });
    }
  }

  /// <summary>Saves the committed scene; a file of that name stays whole until all is written.
  /// </summary>
  public void Save(string path) {
    using (var name = new Pin(Encoding.UTF8.GetBytes(path + "\0")))
    using (var desc = new Pin(new kiwami_save_desc[1])) {
      Native.kiwami_save_desc_init(desc.Address, (UIntPtr)kiwami_save_desc.Size);
      var fields = Marshal.PtrToStructure<kiwami_save_desc>(desc.Address);
      fields.path = name.Address;
      Marshal.StructureToPtr(fields, desc.Address, false);
      Call(scene => Native.kiwami_scene_save(scene, desc.Address, IntPtr.Zero));
    }
  }

  /// <summary>Loads a scene that Save wrote. map: use the file where it lies; it may not change
  /// meanwhile. trusted: check nothing, for files that nobody else could change.</summary>
  public static Scene Load(Device device, string path, bool map = false, bool trusted = false) {
    using (var name = new Pin(Encoding.UTF8.GetBytes(path + "\0")))
    using (var desc = new Pin(new kiwami_load_desc[1]))
    using (var made = new Pin(new IntPtr[1])) {
      IntPtr owner = device.DangerousGetHandle();
      Native.kiwami_load_desc_init(desc.Address, (UIntPtr)kiwami_load_desc.Size);
      var fields = Marshal.PtrToStructure<kiwami_load_desc>(desc.Address);
      fields.path = name.Address;
      fields.flags = (map ? Native.KIWAMI_LOAD_MAP : 0) |
                     (trusted ? Native.KIWAMI_LOAD_TRUSTED : 0);
      Marshal.StructureToPtr(fields, desc.Address, false);
      KiwamiException.Check(Native.kiwami_scene_load(owner, desc.Address, made.Address), owner);
      GC.KeepAlive(device);
      return new Scene(owner, Marshal.ReadIntPtr(made.Address));
    }
  }

  /// <summary>The closest hit of each ray. filter, here and below, decides which hits count.
  /// </summary>
  public Hit[] ClosestHit(Ray[] rays, Filter filter = null) {
    var hits = new Hit[rays.Length];
    ClosestHit(rays, hits, filter);
    return hits;
  }

  /// <summary>The same, into hits, of which there must be as many as rays.</summary>
  public void ClosestHit(Ray[] rays, Hit[] hits, Filter filter = null) {
    if (hits.Length != rays.Length) {
      throw new ArgumentException("hits has length " + hits.Length + ", expected " + rays.Length);
    }
    using (var from = new Pin(rays))
    using (var to = new Pin(hits)) {
      Trace(filter, (scene, query) => Native.kiwami_closest_hit(
                        scene, from.Address, UIntPtr.Zero, to.Address, UIntPtr.Zero,
                        (UIntPtr)rays.Length, query));
    }
  }

  /// <summary>Whether each ray has a hit.</summary>
  public bool[] AnyHit(Ray[] rays, Filter filter = null) {
    var occluded = new byte[rays.Length];
    using (var from = new Pin(rays))
    using (var to = new Pin(occluded)) {
      Trace(filter, (scene, query) => Native.kiwami_any_hit(
                        scene, from.Address, UIntPtr.Zero, to.Address, UIntPtr.Zero,
                        (UIntPtr)rays.Length, query));
    }
    return Array.ConvertAll(occluded, each => each != 0);
  }

  /// <summary>The nearest maxHits hits of each ray, by rising distance; 0 stands for all.</summary>
  public MultiHits MultiHit(Ray[] rays, uint maxHits = 0, Filter filter = null) {
    var found = new MultiHits { Offsets = new ulong[rays.Length + 1], Hits = new Hit[rays.Length] };
    int result;
    do {
      using (var from = new Pin(rays))
      using (var to = new Pin(found.Hits))
      using (var offsets = new Pin(found.Offsets)) {
        result = Trace(filter, (scene, query) => Native.kiwami_multi_hit(
                                   scene, from.Address, UIntPtr.Zero, (UIntPtr)rays.Length, maxHits,
                                   to.Address, (ulong)found.Hits.Length, offsets.Address, query));
      }
      var hits = found.Hits;
      Array.Resize(ref hits, (int)found.Offsets[rays.Length]);
      found.Hits = hits;
    } while (result == Native.KIWAMI_ERROR_CAPACITY);
    return found;
  }

  /// <summary>How many hits each ray has.</summary>
  public uint[] CountHits(Ray[] rays, Filter filter = null) {
    var counts = new uint[rays.Length];
    using (var from = new Pin(rays))
    using (var to = new Pin(counts)) {
      Trace(filter, (scene, query) => Native.kiwami_count_hits(
                        scene, from.Address, UIntPtr.Zero, to.Address, UIntPtr.Zero,
                        (UIntPtr)rays.Length, query));
    }
    return counts;
  }
}

}
