// SPDX-License-Identifier: Apache-2.0
// Kiwami for C#: safe handles, spans-like arrays without copies, exceptions, over P/Invoke.
using System;
using System.Runtime.InteropServices;
using System.Text;
using Kiwami.Interop;

namespace Kiwami {

/// <summary>An error of the library: its number, its sentence as Message, and, where a callback threw,
/// what it threw as InnerException.</summary>
public sealed class KiwamiException : Exception {
  public int Result { get; }

  public KiwamiException(int result, string sentence, Exception cause = null)
      : base(sentence, cause) {
    Result = result;
  }

  /// <summary>The same error, of which a callback is the cause.</summary>
  internal KiwamiException With(Exception cause) {
    return new KiwamiException(Result, Message + ": " + cause.Message, cause);
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

}
