// SPDX-License-Identifier: Apache-2.0
package org.kiwami;

import com.sun.jna.Memory;
import com.sun.jna.Pointer;
import java.lang.ref.Reference;
import java.util.HashMap;
import java.util.Map;

/** Makes geometries of arrays, and holds those that are attached to one scene. */
final class Geometries {
  /** One of the library's functions that make a geometry. */
  private interface Create {
    int call(Pointer device, Pointer desc, Pointer geometry);
  }

  private static final class Attached {
    final Pointer geometry;
    /** Of a triangle mesh; else -1. */
    final int vertexNumbers;

    Attached(Pointer geometry, int vertexNumbers) {
      this.geometry = geometry;
      this.vertexNumbers = vertexNumbers;
    }
  }

  private final Pointer device;
  private final Map<Integer, Attached> attached = new HashMap<>();

  Geometries(Pointer device) {
    this.device = device;
  }

  private void check(int result) {
    KiwamiException.check(result, device);
  }

  /** Lets go of all. */
  void release() {
    attached.values().forEach(each -> Native.kiwami_geometry_release(each.geometry));
    attached.clear();
  }

  void remove(Pointer scene, int geometryId) {
    check(Native.kiwami_scene_detach(scene, geometryId));
    Attached removed = attached.remove(geometryId);
    if (removed != null) {
      Native.kiwami_geometry_release(removed.geometry);
    }
  }

  static Memory copy(float[] values) {
    Memory memory = new Memory(Math.max(4L * values.length, 1));
    memory.write(0, values, 0, values.length);
    return memory;
  }

  static Memory copy(int[] values) {
    Memory memory = new Memory(Math.max(4L * values.length, 1));
    memory.write(0, values, 0, values.length);
    return memory;
  }

  static int rows(int numbers, int columns, String name) {
    if (numbers % columns != 0) {
      throw new IllegalArgumentException(
          name + " has " + numbers + " numbers, expected a multiple of " + columns);
    }
    return numbers / columns;
  }

  private static void requireRows(int numbers, int columns, int expected, String name) {
    int found = rows(numbers, columns, name);
    if (found != expected) {
      throw new IllegalArgumentException(name + " has " + found + " rows, expected " + expected);
    }
  }

  /** Attaches what the descriptor says; copies are what it points to. */
  private int add(
      Pointer scene, Create create, Memory desc, int vertexNumbers, Object... copies) {
    Memory made = new Memory(com.sun.jna.Native.POINTER_SIZE);
    check(create.call(device, desc, made));
    Reference.reachabilityFence(copies);
    Pointer geometry = made.getPointer(0);
    Memory number = new Memory(4);
    int result = Native.kiwami_scene_attach(scene, geometry, number);
    if (result != Native.KIWAMI_OK) {
      Native.kiwami_geometry_release(geometry);
    }
    check(result);
    attached.put(number.getInt(0), new Attached(geometry, vertexNumbers));
    return number.getInt(0);
  }

  int addMesh(Pointer scene, float[] vertices, int[] triangles, int mask) {
    int vertexCount = rows(vertices.length, 3, "vertices");
    int triangleCount = rows(triangles.length, 3, "triangles");
    Memory positions = copy(vertices);
    Memory indices = copy(triangles);
    Memory desc = new Memory(Native.TriangleMeshDesc.STRUCT_BYTES);
    check(Native.kiwami_triangle_mesh_desc_init(desc, desc.size()));
    desc.setPointer(Native.TriangleMeshDesc.VERTICES, positions);
    desc.setLong(Native.TriangleMeshDesc.VERTEX_COUNT, vertexCount);
    desc.setPointer(Native.TriangleMeshDesc.INDICES, indices);
    desc.setLong(Native.TriangleMeshDesc.TRIANGLE_COUNT, triangleCount);
    desc.setInt(Native.TriangleMeshDesc.MASK, mask);
    return add(
        scene, Native::kiwami_triangle_mesh_create, desc, vertices.length, positions, indices);
  }

  int addMovingMesh(
      Pointer scene,
      float[] vertices,
      int stepCount,
      int[] triangles,
      float timeBegin,
      float timeEnd,
      int mask) {
    int vertexCount = rows(vertices.length, 3 * Math.max(stepCount, 1), "vertices of all steps");
    int triangleCount = rows(triangles.length, 3, "triangles");
    Memory positions = copy(vertices);
    Memory indices = copy(triangles);
    Memory desc = new Memory(Native.MovingMeshDesc.STRUCT_BYTES);
    check(Native.kiwami_moving_mesh_desc_init(desc, desc.size()));
    desc.setPointer(Native.MovingMeshDesc.VERTICES, positions);
    desc.setLong(Native.MovingMeshDesc.VERTEX_COUNT, vertexCount);
    desc.setPointer(Native.MovingMeshDesc.INDICES, indices);
    desc.setLong(Native.MovingMeshDesc.TRIANGLE_COUNT, triangleCount);
    desc.setInt(Native.MovingMeshDesc.STEP_COUNT, stepCount);
    desc.setFloat(Native.MovingMeshDesc.TIME_BEGIN, timeBegin);
    desc.setFloat(Native.MovingMeshDesc.TIME_END, timeEnd);
    desc.setInt(Native.MovingMeshDesc.MASK, mask);
    return add(scene, Native::kiwami_moving_mesh_create, desc, -1, positions, indices);
  }

  int addSpheres(Pointer scene, float[] points, int mask) {
    int count = rows(points.length, 4, "points");
    Memory copied = copy(points);
    Memory desc = new Memory(Native.SpheresDesc.STRUCT_BYTES);
    check(Native.kiwami_spheres_desc_init(desc, desc.size()));
    desc.setPointer(Native.SpheresDesc.POINTS, copied);
    desc.setLong(Native.SpheresDesc.SPHERE_COUNT, count);
    desc.setInt(Native.SpheresDesc.MASK, mask);
    return add(scene, Native::kiwami_spheres_create, desc, -1, copied);
  }

  int addDiscs(Pointer scene, float[] points, float[] normals, int mask) {
    int count = rows(points.length, 4, "points");
    requireRows(normals.length, 3, count, "normals");
    Memory copied = copy(points);
    Memory directions = copy(normals);
    Memory desc = new Memory(Native.DiscsDesc.STRUCT_BYTES);
    check(Native.kiwami_discs_desc_init(desc, desc.size()));
    desc.setPointer(Native.DiscsDesc.POINTS, copied);
    desc.setPointer(Native.DiscsDesc.NORMALS, directions);
    desc.setLong(Native.DiscsDesc.DISC_COUNT, count);
    desc.setInt(Native.DiscsDesc.MASK, mask);
    return add(scene, Native::kiwami_discs_create, desc, -1, copied, directions);
  }

  int addCurves(Pointer scene, float[] points, int[] segments, int mask) {
    int count = rows(points.length, 4, "points");
    Memory copied = copy(points);
    Memory indices = copy(segments);
    Memory desc = new Memory(Native.CurvesDesc.STRUCT_BYTES);
    check(Native.kiwami_curves_desc_init(desc, desc.size()));
    desc.setPointer(Native.CurvesDesc.POINTS, copied);
    desc.setLong(Native.CurvesDesc.POINT_COUNT, count);
    desc.setPointer(Native.CurvesDesc.INDICES, indices);
    desc.setLong(Native.CurvesDesc.SEGMENT_COUNT, segments.length);
    desc.setInt(Native.CurvesDesc.MASK, mask);
    return add(scene, Native::kiwami_curves_create, desc, -1, copied, indices);
  }

  int addInstances(
      Pointer scene,
      Pointer[] scenes,
      float[] transforms,
      int[] sceneIndices,
      int[] masks,
      int mask) {
    int count = rows(transforms.length, 12, "transforms");
    Memory shown = new Memory(Math.max((long) com.sun.jna.Native.POINTER_SIZE * scenes.length, 1));
    for (int i = 0; i < scenes.length; ++i) {
      shown.setPointer((long) com.sun.jna.Native.POINTER_SIZE * i, scenes[i]);
    }
    Memory rows = copy(transforms);
    Memory indices = null;
    Memory own = null;
    Memory desc = new Memory(Native.InstancesDesc.STRUCT_BYTES);
    check(Native.kiwami_instances_desc_init(desc, desc.size()));
    if (sceneIndices != null) {
      requireRows(sceneIndices.length, 1, count, "sceneIndices");
      indices = copy(sceneIndices);
      desc.setPointer(Native.InstancesDesc.SCENE_INDICES, indices);
    }
    if (masks != null) {
      requireRows(masks.length, 1, count, "masks");
      own = copy(masks);
      desc.setPointer(Native.InstancesDesc.MASKS, own);
    }
    desc.setPointer(Native.InstancesDesc.SCENES, shown);
    desc.setLong(Native.InstancesDesc.SCENE_COUNT, scenes.length);
    desc.setPointer(Native.InstancesDesc.TRANSFORMS, rows);
    desc.setLong(Native.InstancesDesc.COUNT, count);
    desc.setInt(Native.InstancesDesc.MASK, mask);
    return add(scene, Native::kiwami_instances_create, desc, -1, shown, rows, indices, own);
  }

  void updateVertices(int geometryId, float[] vertices) {
    Attached mesh = attached.get(geometryId);
    if (mesh == null || mesh.vertexNumbers != vertices.length) {
      throw new IllegalArgumentException(
          "geometry " + geometryId + " is no mesh of " + vertices.length + " numbers");
    }
    Memory positions = copy(vertices);
    check(Native.kiwami_triangle_mesh_update_vertices(mesh.geometry, positions, 0, 0));
    Reference.reachabilityFence(positions);
  }
}
