// SPDX-License-Identifier: Apache-2.0
// Kiwami for C#: safe handles, spans-like arrays without copies, exceptions, over P/Invoke.
using System;
using System.Runtime.InteropServices;
using System.Text;
using Kiwami.Interop;

namespace Kiwami {

/// <summary>An error of the library: its number, and its sentence as Message.</summary>
public sealed class KiwamiException : Exception {
  public int Result { get; }

  public KiwamiException(int result, string sentence) : base(sentence) {
    Result = result;
  }

  /// <summary>Throws what a result stands for, unless it is success.</summary>
  internal static void Check(int result, IntPtr device) {
    if (result == Native.KIWAMI_OK) return;
    var text = new byte[1024];
    using (var pin = new Pin(text)) {
      Native.kiwami_last_error(device, pin.Address, (UIntPtr)text.Length);
    }
    int length = Array.IndexOf(text, (byte)0);
    string sentence = Encoding.UTF8.GetString(text, 0, length);
    if (length == 0) sentence = Marshal.PtrToStringAnsi(Native.kiwami_result_name(result));
    throw new KiwamiException(result, sentence);
  }
}

/// <summary>Keeps an array where it is while the library works on it.</summary>
internal struct Pin : IDisposable {
  GCHandle handle;

  public Pin(Array array) {
    handle = GCHandle.Alloc(array, GCHandleType.Pinned);
  }
  public IntPtr Address {
    get { return handle.AddrOfPinnedObject(); }
  }
  public void Dispose() {
    handle.Free();
  }
}

/// <summary>The instruction sets.</summary>
public enum Isa : uint {
  Auto = Native.KIWAMI_ISA_AUTO,
  Scalar = Native.KIWAMI_ISA_SCALAR,
  Sse = Native.KIWAMI_ISA_SSE,
  Avx2 = Native.KIWAMI_ISA_AVX2,
  Avx512 = Native.KIWAMI_ISA_AVX512
}

/// <summary>The points Origin + t * Direction with TMin &lt;= t &lt;= TMax; laid out as in C.</summary>
[StructLayout(LayoutKind.Sequential)]
public struct Ray {
  public const uint CullBackFaces = Native.KIWAMI_RAY_CULL_BACK_FACES;
  public const uint CullFrontFaces = Native.KIWAMI_RAY_CULL_FRONT_FACES;

  public float OriginX, OriginY, OriginZ;
  public float TMin;
  public float DirectionX, DirectionY, DirectionZ;
  public float TMax;
  public float Time;
  public uint Mask;
  public uint Flags;
  public uint Id;

  /// <summary>A ray without end that meets meshes of all masks.</summary>
  public Ray(float originX, float originY, float originZ, float directionX, float directionY,
             float directionZ) {
    OriginX = originX;
    OriginY = originY;
    OriginZ = originZ;
    TMin = 0;
    DirectionX = directionX;
    DirectionY = directionY;
    DirectionZ = directionZ;
    TMax = float.PositiveInfinity;
    Time = 0;
    Mask = uint.MaxValue;
    Flags = Id = 0;
  }
}

/// <summary>The answer to a ray; laid out as in C. A miss has an infinite T.</summary>
[StructLayout(LayoutKind.Sequential)]
public struct Hit {
  public const uint InvalidId = Native.KIWAMI_INVALID_ID;

  public float T, U, V;
  public float NormalX, NormalY, NormalZ;
  public uint PrimitiveId, GeometryId, InstanceId;

  public bool IsHit {
    get { return PrimitiveId != InvalidId; }
  }
}

/// <summary>Kernels of one instruction set and the threads that run them.</summary>
public sealed class Device : SafeHandle {
  /// <summary>threadCount 0: one thread per processor.</summary>
  public Device(Isa isa = Isa.Auto, uint threadCount = 0, bool validate = false)
      : base(IntPtr.Zero, true) {
    var desc = new Pin(new kiwami_device_desc[1]);
    using (desc) {
      KiwamiException.Check(
          Native.kiwami_device_desc_init(desc.Address, (UIntPtr)kiwami_device_desc.Size),
          IntPtr.Zero);
      var fields = Marshal.PtrToStructure<kiwami_device_desc>(desc.Address);
      fields.isa = (uint)isa;
      fields.thread_count = threadCount;
      fields.flags = validate ? Native.KIWAMI_DEVICE_VALIDATE : 0;
      Marshal.StructureToPtr(fields, desc.Address, false);
      var made = new IntPtr[1];
      using (var target = new Pin(made)) {
        KiwamiException.Check(Native.kiwami_device_create(desc.Address, target.Address),
                              IntPtr.Zero);
      }
      SetHandle(made[0]);
    }
  }

  public override bool IsInvalid {
    get { return handle == IntPtr.Zero; }
  }
  protected override bool ReleaseHandle() {
    Native.kiwami_device_release(handle);
    return true;
  }

  /// <summary>The lower-case name of the instruction set whose kernels run.</summary>
  public string IsaName {
    get {
      var info = new kiwami_device_info[1];
      info[0].struct_size = kiwami_device_info.Size;
      using (var pin = new Pin(info)) {
        KiwamiException.Check(Native.kiwami_device_get_info(handle, pin.Address), handle);
      }
      GC.KeepAlive(this);
      return Marshal.PtrToStringAnsi(Native.kiwami_isa_name(info[0].isa));
    }
  }
}

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
public sealed class Scene : SafeHandle {
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
  protected override bool ReleaseHandle() {
    Native.kiwami_scene_release(handle);
    Native.kiwami_device_release(device);
    return true;
  }

  void Check(int result) {
    KiwamiException.Check(result, device);
  }

  /// <summary>The scene's address for the length of one call. Disposed scenes are an error.</summary>
  int Call(Func<IntPtr, int> call) {
    bool isHeld = false;
    try {
      DangerousAddRef(ref isHeld);
      int result = call(handle);
      if (result != Native.KIWAMI_ERROR_CAPACITY) Check(result);
      return result;
    } finally {
      if (isHeld) DangerousRelease();
    }
  }

  /// <summary>Adds a mesh, copied: three numbers a vertex, three a triangle. Returns the number that
  /// hits report. Only a ray with (ray.Mask &amp; mask) != 0 meets it.</summary>
  public uint AddMesh(float[] vertices, uint[] triangles, uint mask = uint.MaxValue) {
    if (vertices.Length % 3 != 0 || triangles.Length % 3 != 0) {
      throw new ArgumentException(
          "vertices has " + vertices.Length + " and triangles " + triangles.Length +
          " numbers, expected multiples of 3");
    }
    var number = new uint[1];
    using (var positions = new Pin(vertices))
    using (var indices = new Pin(triangles))
    using (var target = new Pin(number))
    using (var desc = new Pin(new kiwami_triangle_mesh_desc[1]))
    using (var made = new Pin(new IntPtr[1])) {
      Native.kiwami_triangle_mesh_desc_init(desc.Address,
                                            (UIntPtr)kiwami_triangle_mesh_desc.Size);
      var fields = Marshal.PtrToStructure<kiwami_triangle_mesh_desc>(desc.Address);
      fields.vertices = positions.Address;
      fields.vertex_count = (ulong)vertices.Length / 3;
      // An empty array has an address too; NULL would stand for a mesh without indices.
      fields.indices = triangles.Length == 0 ? target.Address : indices.Address;
      fields.triangle_count = (ulong)triangles.Length / 3;
      fields.mask = mask;
      Marshal.StructureToPtr(fields, desc.Address, false);
      Call(scene => {
        int result = Native.kiwami_triangle_mesh_create(device, desc.Address, made.Address);
        if (result != Native.KIWAMI_OK) return result;
        IntPtr geometry = Marshal.ReadIntPtr(made.Address);
        result = Native.kiwami_scene_attach(scene, geometry, target.Address);
        Native.kiwami_geometry_release(geometry);
        return result;
      });
    }
    return number[0];
  }

  /// <summary>Removes a mesh; its number becomes free.</summary>
  public void Remove(uint geometryId) {
    Call(scene => Native.kiwami_scene_detach(scene, geometryId));
  }

  /// <summary>Sets one of KIWAMI_PARAMETER_* of scene.h.</summary>
  public void SetParameter(uint parameter, double value) {
    Call(scene => Native.kiwami_scene_set_parameter(scene, parameter, value));
  }

  /// <summary>Builds the acceleration structure of what the scene holds now.</summary>
  public void Commit() {
    Call(Native.kiwami_scene_commit);
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

  /// <summary>The closest hit of each ray.</summary>
  public Hit[] ClosestHit(Ray[] rays) {
    var hits = new Hit[rays.Length];
    ClosestHit(rays, hits);
    return hits;
  }

  /// <summary>The same, into hits, of which there must be as many as rays.</summary>
  public void ClosestHit(Ray[] rays, Hit[] hits) {
    if (hits.Length != rays.Length) {
      throw new ArgumentException("hits has length " + hits.Length + ", expected " + rays.Length);
    }
    using (var from = new Pin(rays))
    using (var to = new Pin(hits)) {
      Call(scene => Native.kiwami_closest_hit(scene, from.Address, UIntPtr.Zero, to.Address,
                                              UIntPtr.Zero, (UIntPtr)rays.Length, IntPtr.Zero));
    }
  }

  /// <summary>Whether each ray has a hit.</summary>
  public bool[] AnyHit(Ray[] rays) {
    var occluded = new byte[rays.Length];
    using (var from = new Pin(rays))
    using (var to = new Pin(occluded)) {
      Call(scene => Native.kiwami_any_hit(scene, from.Address, UIntPtr.Zero, to.Address,
                                          UIntPtr.Zero, (UIntPtr)rays.Length, IntPtr.Zero));
    }
    return Array.ConvertAll(occluded, each => each != 0);
  }

  /// <summary>The nearest maxHits hits of each ray, by rising distance; 0 stands for all.</summary>
  public MultiHits MultiHit(Ray[] rays, uint maxHits = 0) {
    var found = new MultiHits { Offsets = new ulong[rays.Length + 1], Hits = new Hit[rays.Length] };
    int result;
    do {
      using (var from = new Pin(rays))
      using (var to = new Pin(found.Hits))
      using (var offsets = new Pin(found.Offsets)) {
        result = Call(scene => Native.kiwami_multi_hit(
                          scene, from.Address, UIntPtr.Zero, (UIntPtr)rays.Length, maxHits,
                          to.Address, (ulong)found.Hits.Length, offsets.Address, IntPtr.Zero));
      }
      var hits = found.Hits;
      Array.Resize(ref hits, (int)found.Offsets[rays.Length]);
      found.Hits = hits;
    } while (result == Native.KIWAMI_ERROR_CAPACITY);
    return found;
  }

  /// <summary>How many hits each ray has.</summary>
  public uint[] CountHits(Ray[] rays) {
    var counts = new uint[rays.Length];
    using (var from = new Pin(rays))
    using (var to = new Pin(counts)) {
      Call(scene => Native.kiwami_count_hits(scene, from.Address, UIntPtr.Zero, to.Address,
                                             UIntPtr.Zero, (UIntPtr)rays.Length, IntPtr.Zero));
    }
    return counts;
  }
}

}
