// SPDX-License-Identifier: Apache-2.0
// Scenes: what they hold.
using System;
using System.Collections.Generic;
using System.Linq;
using System.Runtime.InteropServices;
using Kiwami.Interop;

namespace Kiwami {

/// <summary>One reference to a geometry.</summary>
internal sealed class Geometry : SafeHandle {
  /// <summary>Of a triangle mesh; else 0.</summary>
  public readonly int VertexNumbers;

  public Geometry(IntPtr geometry, int vertexNumbers) : base(IntPtr.Zero, true) {
    SetHandle(geometry);
    VertexNumbers = vertexNumbers;
  }
  public override bool IsInvalid {
    get { return handle == IntPtr.Zero; }
  }
  protected override bool ReleaseHandle() {
    Native.kiwami_geometry_release(handle);
    return true;
  }
}

public sealed partial class Scene {
  readonly Dictionary<uint, Geometry> attached = new Dictionary<uint, Geometry>();

  delegate int Init(IntPtr desc, UIntPtr size);
  delegate int Create(IntPtr device, IntPtr desc, IntPtr geometry);
  delegate T Change<T>(T fields);

  /// <summary>Makes a geometry of a descriptor whose defaults are changed, and attaches it.
  /// </summary>
  uint Add<T>(Init init, Create create, Change<T> change, int vertexNumbers = 0) where T : struct {
    using (var desc = new Pin(new T[1])) {
      Check(init(desc.Address, (UIntPtr)Marshal.SizeOf<T>()));
      T fields = change(Marshal.PtrToStructure<T>(desc.Address));
      Marshal.StructureToPtr(fields, desc.Address, false);
      return Attach(made => create(device, desc.Address, made), vertexNumbers);
    }
  }

  uint Attach(Func<IntPtr, int> create, int vertexNumbers = 0) {
    var number = new uint[1];
    using (var target = new Pin(number))
    using (var made = new Pin(new IntPtr[1])) {
      Call(scene => create(made.Address));
      var geometry = new Geometry(Marshal.ReadIntPtr(made.Address), vertexNumbers);
      try {
        Call(scene => Native.kiwami_scene_attach(scene, geometry.DangerousGetHandle(),
                                                 target.Address));
      } catch {
        geometry.Dispose();
        throw;
      }
      attached[number[0]] = geometry;
    }
    return number[0];
  }

  /// <summary>The number of rows of so many numbers each.</summary>
  static ulong Rows(Array numbers, int columns, string name) {
    if (numbers.Length % columns != 0) {
      throw new ArgumentException(name + " has " + numbers.Length +
                                  " numbers, expected a multiple of " + columns);
    }
    return (ulong)(numbers.Length / columns);
  }

  static void RequireRows(Array numbers, int columns, ulong expected, string name) {
    ulong found = Rows(numbers, columns, name);
    if (found != expected) {
      throw new ArgumentException(name + " has " + found + " rows, expected " + expected);
    }
  }

  /// <summary>An empty array has an address too: 0 would stand for a mesh without indices.</summary>
  static Pin PinIndices(uint[] indices) {
    return new Pin(indices.Length == 0 ? new uint[1] : indices);
  }

  /// <summary>Adds a mesh, copied: three numbers a vertex, three a triangle. Returns the number that
  /// hits report. Only a ray with (ray.Mask &amp; mask) != 0 meets it.</summary>
  public uint AddMesh(float[] vertices, uint[] triangles, uint mask = uint.MaxValue) {
    ulong vertexCount = Rows(vertices, 3, "vertices");
    ulong triangleCount = Rows(triangles, 3, "triangles");
    using (var positions = new Pin(vertices))
    using (var indices = PinIndices(triangles)) {
      return Add<kiwami_triangle_mesh_desc>(
          Native.kiwami_triangle_mesh_desc_init, Native.kiwami_triangle_mesh_create, fields => {
            fields.vertices = positions.Address;
            fields.vertex_count = vertexCount;
            fields.indices = indices.Address;
            fields.triangle_count = triangleCount;
            fields.mask = mask;
            return fields;
          }, vertices.Length);
    }
  }

  /// <summary>Adds a mesh whose vertices move from step to step between two times: vertices has
  /// those of all steps, one step after the other.</summary>
  public uint AddMovingMesh(float[] vertices, uint stepCount, uint[] triangles, float timeBegin = 0,
                            float timeEnd = 1, uint mask = uint.MaxValue) {
    ulong vertexCount = Rows(vertices, 3 * (int)Math.Max(stepCount, 1), "vertices of all steps");
    ulong triangleCount = Rows(triangles, 3, "triangles");
    using (var positions = new Pin(vertices))
    using (var indices = PinIndices(triangles)) {
      return Add<kiwami_moving_mesh_desc>(
          Native.kiwami_moving_mesh_desc_init, Native.kiwami_moving_mesh_create, fields => {
            fields.vertices = positions.Address;
            fields.vertex_count = vertexCount;
            fields.indices = indices.Address;
            fields.triangle_count = triangleCount;
            fields.step_count = stepCount;
            fields.time_begin = timeBegin;
            fields.time_end = timeEnd;
            fields.mask = mask;
            return fields;
          });
    }
  }

  /// <summary>Adds spheres: x, y, z and radius.</summary>
  public uint AddSpheres(float[] points, uint mask = uint.MaxValue) {
    ulong count = Rows(points, 4, "points");
    using (var rows = new Pin(points)) {
      return Add<kiwami_spheres_desc>(
          Native.kiwami_spheres_desc_init, Native.kiwami_spheres_create, fields => {
            fields.points = rows.Address;
            fields.sphere_count = count;
            fields.mask = mask;
            return fields;
          });
    }
  }

  /// <summary>Adds flat discs: x, y, z and radius, and a normal of three numbers each.</summary>
  public uint AddDiscs(float[] points, float[] normals, uint mask = uint.MaxValue) {
    ulong count = Rows(points, 4, "points");
    RequireRows(normals, 3, count, "normals");
    using (var rows = new Pin(points))
    using (var directions = new Pin(normals)) {
      return Add<kiwami_discs_desc>(
          Native.kiwami_discs_desc_init, Native.kiwami_discs_create, fields => {
            fields.points = rows.Address;
            fields.normals = directions.Address;
            fields.disc_count = count;
            fields.mask = mask;
            return fields;
          });
    }
  }

  /// <summary>Adds round curve segments: segment i joins the points segments[i] and segments[i] + 1,
  /// each of x, y, z and radius.</summary>
  public uint AddCurves(float[] points, uint[] segments, uint mask = uint.MaxValue) {
    ulong count = Rows(points, 4, "points");
    using (var rows = new Pin(points))
    using (var indices = PinIndices(segments)) {
      return Add<kiwami_curves_desc>(
          Native.kiwami_curves_desc_init, Native.kiwami_curves_create, fields => {
            fields.points = rows.Address;
            fields.point_count = count;
            fields.indices = indices.Address;
            fields.segment_count = (ulong)segments.Length;
            fields.mask = mask;
            return fields;
          });
    }
  }

  /// <summary>Adds instances of these scenes: transforms has three rows of four numbers each, from
  /// the scene's space to the outer one; sceneIndices says which scene each shows (null: the first),
  /// masks which rays enter it (null: all). A commit shows what the scenes have committed by then,
  /// and may not overlap with theirs.</summary>
  public uint AddInstances(Scene[] scenes, float[] transforms, uint[] sceneIndices = null,
                           uint[] masks = null, uint mask = uint.MaxValue) {
    ulong count = Rows(transforms, 12, "transforms");
    if (sceneIndices != null) RequireRows(sceneIndices, 1, count, "sceneIndices");
    if (masks != null) RequireRows(masks, 1, count, "masks");
    int held = 0;
    try {
      foreach (Scene scene in scenes) {
        bool isHeld = false;
        scene.DangerousAddRef(ref isHeld);
        ++held;
      }
      using (var shown = new Pin(scenes.Select(each => each.handle).ToArray()))
      using (var rows = new Pin(transforms))
      using (var indices = new Pin(sceneIndices ?? new uint[count]))
      using (var own = new Pin(masks ?? Enumerable.Repeat(uint.MaxValue, (int)count).ToArray())) {
        return Add<kiwami_instances_desc>(
            Native.kiwami_instances_desc_init, Native.kiwami_instances_create, fields => {
              fields.scenes = shown.Address;
              fields.scene_count = (ulong)scenes.Length;
              fields.scene_indices = indices.Address;
              fields.transforms = rows.Address;
              fields.masks = own.Address;
              fields.count = count;
              fields.mask = mask;
              return fields;
            });
      }
    } finally {
      for (int i = 0; i < held; ++i) scenes[i].DangerousRelease();
    }
  }

  /// <summary>Adds count primitives of the caller's own kind, which are held until no scene uses them
  /// any more.</summary>
  public uint AddUserGeometry(ulong count, IUserGeometry primitives, uint mask = uint.MaxValue) {
    if (primitives == null) throw new ArgumentNullException("primitives");
    return Attach(made => UserCallbacks.Create(device, count, primitives, mask, made));
  }

  /// <summary>Gives a mesh other vertices, as many as it has; Refit or Commit shows them.</summary>
  public void UpdateVertices(uint geometryId, float[] vertices) {
    Geometry mesh;
    if (!attached.TryGetValue(geometryId, out mesh) || mesh.VertexNumbers != vertices.Length) {
      throw new ArgumentException("geometry " + geometryId + " is no mesh of " +
                                  vertices.Length + " numbers");
    }
    using (var positions = new Pin(vertices)) {
      Call(scene => Native.kiwami_triangle_mesh_update_vertices(mesh.DangerousGetHandle(),
                                                                positions.Address, 0, 0));
    }
  }

  /// <summary>Leaves a geometry out, or takes it in again, under its number.</summary>
  public void Enable(uint geometryId, bool isEnabled = true) {
    Call(scene => Native.kiwami_scene_enable(scene, geometryId, isEnabled ? 1 : 0));
  }

  /// <summary>Removes a geometry; its number becomes free.</summary>
  public void Remove(uint geometryId) {
    Call(scene => Native.kiwami_scene_detach(scene, geometryId));
    Geometry geometry;
    if (attached.TryGetValue(geometryId, out geometry)) geometry.Dispose();
    attached.Remove(geometryId);
  }
}

}
