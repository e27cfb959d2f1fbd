// SPDX-License-Identifier: Apache-2.0
// Many lights: which of them a point should ask.
using System;
using System.Runtime.InteropServices;
using Kiwami.Interop;

namespace Kiwami {

/// <summary>Three numbers.</summary>
[StructLayout(LayoutKind.Sequential)]
public struct Vector {
  public float X, Y, Z;

  public Vector(float x, float y, float z) {
    X = x;
    Y = y;
    Z = z;
  }
}

/// <summary>The kinds of lights.</summary>
public enum LightKind : uint {
  Point = Native.KIWAMI_LIGHT_POINT,
  Spot = Native.KIWAMI_LIGHT_SPOT,
  Triangle = Native.KIWAMI_LIGHT_TRIANGLE,
  Quad = Native.KIWAMI_LIGHT_QUAD,
  Sphere = Native.KIWAMI_LIGHT_SPHERE,
  Disc = Native.KIWAMI_LIGHT_DISC,
  Distant = Native.KIWAMI_LIGHT_DISTANT,
  Environment = Native.KIWAMI_LIGHT_ENVIRONMENT
}

/// <summary>A light; laid out as in C. See light.h for which fields each kind has.</summary>
[StructLayout(LayoutKind.Sequential)]
public struct Light {
  public const uint TwoSided = Native.KIWAMI_LIGHT_TWO_SIDED;

  public LightKind Kind;
  public uint Flags;
  public Vector Point0, Point1, Point2, Point3;
  public Vector Direction;
  public float Radius;
  public float CosInner, CosOuter;
  /// <summary>What it emits in all: only ratios count.</summary>
  public float Power;
  /// <summary>The caller's own; copied to the choices.</summary>
  public uint UserId;
  /// <summary>Lights a receiver only if (LinkMask &amp; receiver.LinkMask) != 0.</summary>
  public ulong LinkMask;
}

/// <summary>Who asks for a light: a point with a normal, a point without (Normal 0, 0, 0), or a
/// segment; laid out as in C.</summary>
[StructLayout(LayoutKind.Sequential)]
public struct LightReceiver {
  public const uint BothSides = Native.KIWAMI_RECEIVER_BOTH_SIDES;

  public Vector Position;
  public Vector Normal;
  /// <summary>From Position to the other end; 0, 0, 0: a point.</summary>
  public Vector Segment;
  public uint Flags;
  public ulong LinkMask;
  /// <summary>At least 0, below 1.</summary>
  public double Random;
}

/// <summary>A light that was chosen; laid out as in C.</summary>
[StructLayout(LayoutKind.Sequential)]
public struct LightChoice {
  /// <summary>Hit.InvalidId: none.</summary>
  public uint LightId;
  /// <summary>The instance through which it is seen; Hit.InvalidId: none.</summary>
  public uint InstanceId;
  public uint UserId;
  /// <summary>With which this choice was made.</summary>
  public float Probability;
  /// <summary>A new random number, for a point on the light.</summary>
  public double Random;
}

/// <summary>Lights, among which points choose in proportion to what may reach them. Changes take
/// effect with Commit or Refit. A committed set can be sampled from any number of threads.</summary>
public sealed class LightTree : SafeHandle {
  readonly IntPtr device;

  /// <summary>width: children of a node: 2, 4, 8 or 16; 0: the device's default.</summary>
  public LightTree(Device device, uint width = 0) : base(IntPtr.Zero, true) {
    this.device = device.DangerousGetHandle();
    using (var desc = new Pin(new kiwami_light_tree_desc[1]))
    using (var made = new Pin(new IntPtr[1])) {
      Native.kiwami_light_tree_desc_init(desc.Address, (UIntPtr)kiwami_light_tree_desc.Size);
      var fields = Marshal.PtrToStructure<kiwami_light_tree_desc>(desc.Address);
      fields.width = width;
      Marshal.StructureToPtr(fields, desc.Address, false);
      KiwamiException.Check(
          Native.kiwami_light_tree_create(this.device, desc.Address, made.Address), this.device);
      Native.kiwami_device_retain(this.device);
      SetHandle(Marshal.ReadIntPtr(made.Address));
    }
    GC.KeepAlive(device);
  }

  public override bool IsInvalid {
    get { return handle == IntPtr.Zero; }
  }
  protected override bool ReleaseHandle() {
    Native.kiwami_light_tree_release(handle);
    Native.kiwami_device_release(device);
    return true;
  }

  void Call(Func<IntPtr, int> call) {
    bool isHeld = false;
    try {
      DangerousAddRef(ref isHeld);
      KiwamiException.Check(call(handle), device);
    } finally {
      if (isHeld) DangerousRelease();
    }
  }

  /// <summary>Adds lights; returns the number of the first.</summary>
  public uint AddLights(Light[] lights) {
    var first = new uint[1];
    using (var from = new Pin(lights))
    using (var target = new Pin(first)) {
      Call(tree => Native.kiwami_light_tree_add_lights(tree, from.Address, UIntPtr.Zero,
                                                       (UIntPtr)lights.Length, target.Address));
    }
    return first[0];
  }

  /// <summary>Makes a light of each triangle; returns the number of the first.</summary>
  public uint AddMesh(float[] vertices, uint[] triangles, float radiance = 1,
                      bool isTwoSided = false) {
    if (vertices.Length % 3 != 0 || triangles.Length % 3 != 0) {
      throw new ArgumentException(
          "vertices has " + vertices.Length + " and triangles " + triangles.Length +
          " numbers, expected multiples of 3");
    }
    var first = new uint[1];
    using (var positions = new Pin(vertices))
    using (var indices = new Pin(triangles.Length == 0 ? new uint[1] : triangles))
    using (var target = new Pin(first))
    using (var desc = new Pin(new kiwami_light_mesh_desc[1])) {
      Native.kiwami_light_mesh_desc_init(desc.Address, (UIntPtr)kiwami_light_mesh_desc.Size);
      var fields = Marshal.PtrToStructure<kiwami_light_mesh_desc>(desc.Address);
      fields.flags = isTwoSided ? Native.KIWAMI_LIGHT_TWO_SIDED : 0;
      fields.vertices = positions.Address;
      fields.vertex_count = (ulong)vertices.Length / 3;
      fields.indices = indices.Address;
      fields.triangle_count = (ulong)triangles.Length / 3;
      fields.radiance = radiance;
      Marshal.StructureToPtr(fields, desc.Address, false);
      Call(tree => Native.kiwami_light_tree_add_mesh(tree, desc.Address, target.Address));
    }
    return first[0];
  }

  /// <summary>Gives the lights from first on other powers.</summary>
  public void SetPowers(uint first, float[] powers) {
    using (var from = new Pin(powers)) {
      Call(tree => Native.kiwami_light_tree_set_powers(tree, first, from.Address, UIntPtr.Zero,
                                                       (UIntPtr)powers.Length));
    }
  }

  /// <summary>Builds the tree over all lights.</summary>
  public void Commit() {
    Call(Native.kiwami_light_tree_commit);
  }

  /// <summary>As Commit, but keeps the shape of the tree.</summary>
  public void Refit() {
    Call(Native.kiwami_light_tree_refit);
  }

  /// <summary>Lets each receiver choose a light.</summary>
  public LightChoice[] Sample(LightReceiver[] receivers) {
    var choices = new LightChoice[receivers.Length];
    using (var from = new Pin(receivers))
    using (var to = new Pin(choices)) {
      Call(tree => Native.kiwami_light_sample(tree, from.Address, UIntPtr.Zero, to.Address,
                                              UIntPtr.Zero, (UIntPtr)receivers.Length,
                                              IntPtr.Zero));
    }
    return choices;
  }

  /// <summary>The probability with which each receiver chooses the light of the choice beside it.
  /// </summary>
  public float[] Pdf(LightReceiver[] receivers, LightChoice[] lights) {
    if (lights.Length != receivers.Length) {
      throw new ArgumentException("lights has length " + lights.Length + ", expected " +
                                  receivers.Length);
    }
    var probabilities = new float[receivers.Length];
    using (var from = new Pin(receivers))
    using (var names = new Pin(lights))
    using (var to = new Pin(probabilities)) {
      // A choice begins with the name of its light.
      Call(tree => Native.kiwami_light_pdf(tree, from.Address, UIntPtr.Zero, names.Address,
                                           (UIntPtr)kiwami_light_choice.Size, to.Address,
                                           UIntPtr.Zero, (UIntPtr)receivers.Length, IntPtr.Zero));
    }
    return probabilities;
  }
}

}
