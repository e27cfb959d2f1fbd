// SPDX-License-Identifier: Apache-2.0
// Primitives of the caller's own kind.
using System;
using System.Runtime.InteropServices;
using Kiwami.Interop;

namespace Kiwami {

/// <summary>A box around a primitive; laid out as in C.</summary>
[StructLayout(LayoutKind.Sequential)]
public struct Box {
  public float LowerX, LowerY, LowerZ;
  public float UpperX, UpperY, UpperZ;
}

/// <summary>A point where a ray meets a primitive; laid out as in C.</summary>
[StructLayout(LayoutKind.Sequential)]
public struct UserHit {
  public float T;
  /// <summary>Whatever the primitives' kind makes of them.</summary>
  public float U, V;
  /// <summary>Outward; need not have length 1.</summary>
  public float NormalX, NormalY, NormalZ;
  /// <summary>One of those that were asked for.</summary>
  public uint PrimitiveId;
  readonly uint reserved;
}

/// <summary>One ray and the primitives that it may meet. It ends with the call.</summary>
public sealed class Intersection {
  IntPtr asked;

  internal unsafe Intersection(IntPtr asked) {
    this.asked = asked;
    var fields = (kiwami_user_intersection*)asked;
    Ray = *(Ray*)fields->ray;
    GeometryId = fields->geometry_id;
    var ids = (uint*)fields->primitive_ids;
    PrimitiveIds = new uint[fields->primitive_count];
    for (int i = 0; i < PrimitiveIds.Length; ++i) PrimitiveIds[i] = ids[i];
  }

  /// <summary>In the geometry's space; its TMax may be nearer than the traced ray's.</summary>
  public Ray Ray { get; }
  public uint GeometryId { get; }
  public uint[] PrimitiveIds { get; }

  /// <summary>Adds a hit of one of the primitives, of which each has at most four. Where Ray.TMin
  /// &lt;= T &lt;= Ray.TMax does not hold it is ignored.</summary>
  public unsafe void Add(UserHit hit) {
    if (asked == IntPtr.Zero) throw new InvalidOperationException("the intersection has ended");
    var fields = (kiwami_user_intersection*)asked;
    if (fields->hit_count == fields->hit_capacity) {
      throw new InvalidOperationException("there are more than four hits a primitive");
    }
    ((UserHit*)fields->hits)[fields->hit_count++] = hit;
  }

  internal void End() {
    asked = IntPtr.Zero;
  }
}

/// <summary>Primitives of the caller's own kind. Several threads ask them at once. What they throw is
/// the InnerException of the error of the commit or the trace call.</summary>
public interface IUserGeometry {
  /// <summary>Fills in a box for each of the primitives from first on.</summary>
  void Bounds(uint first, Box[] boxes);

  /// <summary>Adds the hits of a ray. Those of a primitive must depend on the ray and the primitive
  /// alone, and lie in its box.</summary>
  void Intersect(Intersection intersection);
}

/// <summary>The callbacks of user geometries, held for ever.</summary>
internal static class UserCallbacks {
  static readonly kiwami_user_bounds_function bounds = Bounds;
  static readonly kiwami_user_intersect_function intersect = Intersect;
  static readonly kiwami_user_destroy_function destroy = Destroy;

  /// <summary>The geometry that is made owns a handle, which Destroy frees.</summary>
  public static int Create(IntPtr device, ulong count, IUserGeometry primitives, uint mask,
                           IntPtr made) {
    GCHandle owner = GCHandle.Alloc(primitives);
    using (var desc = new Pin(new kiwami_user_geometry_desc[1])) {
      Native.kiwami_user_geometry_desc_init(desc.Address,
                                            (UIntPtr)kiwami_user_geometry_desc.Size);
      var fields = Marshal.PtrToStructure<kiwami_user_geometry_desc>(desc.Address);
      fields.count = count;
      fields.bounds = Marshal.GetFunctionPointerForDelegate(bounds);
      fields.intersect = Marshal.GetFunctionPointerForDelegate(intersect);
      fields.destroy = Marshal.GetFunctionPointerForDelegate(destroy);
      fields.user = GCHandle.ToIntPtr(owner);
      fields.mask = mask;
      Marshal.StructureToPtr(fields, desc.Address, false);
      int result = Native.kiwami_user_geometry_create(device, desc.Address, made);
      if (result == Native.KIWAMI_OK) {
        UserErrors.Count(1);
      } else {
        owner.Free();
      }
      return result;
    }
  }

  static unsafe int Bounds(IntPtr user, uint first, uint count, IntPtr target) {
    try {
      CallingThread.BeginCallback();
      var boxes = new Box[count];
      ((IUserGeometry)GCHandle.FromIntPtr(user).Target).Bounds(first, boxes);
      for (int i = 0; i < boxes.Length; ++i) ((Box*)target)[i] = boxes[i];
      return 0;
    } catch (Exception exception) {
      UserErrors.Keep(exception);
      return -1;
    }
  }

  static int Intersect(IntPtr user, IntPtr asked) {
    Intersection intersection = null;
    try {
      CallingThread.BeginCallback();
      intersection = new Intersection(asked);
      ((IUserGeometry)GCHandle.FromIntPtr(user).Target).Intersect(intersection);
      return 0;
    } catch (Exception exception) {
      UserErrors.Keep(exception);
      return -1;
    } finally {
      intersection?.End();
    }
  }

  static void Destroy(IntPtr user) {
    GCHandle.FromIntPtr(user).Free();
    UserErrors.Count(-1);
  }
}

}
