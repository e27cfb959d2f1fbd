// SPDX-License-Identifier: Apache-2.0
// What scenes are made of.
'use strict';

const { ALL_MASKS, Handle, addressable, rowsOf, typed } = require('./handle');
const { addressOf, check, native, receiveHandle, withDescriptor } = require('./library');

/** Floats and how many rows of so many there are. */
function floats(values, columns, name) {
  return [typed(Float32Array, values, name), rowsOf(values, columns, name)];
}

function requireRows(values, columns, expected, name) {
  const found = rowsOf(values, columns, name);
  if (found !== expected) throw new RangeError(`${name} has ${found} rows, expected ${expected}`);
}

/** The part of a Scene that holds its geometries. */
class Geometries extends Handle {
  /** Takes over references to a scene and its device. */
  constructor(scene, device) {
    const attached = new Map();
    const owned = { scene };
    super(scene, () => {
      for (const { geometry } of attached.values()) native.kiwami_geometry_release(geometry);
      attached.clear();
      native.kiwami_scene_release(owned.scene);
      native.kiwami_device_release(device);
    });
    this.device = device;
    this.attached = attached;
    this.owned = owned;
  }

  /** Owns another scene in place of this one. */
  replace(scene) {
    native.kiwami_scene_release(this.owned.scene);
    this.object = this.owned.scene = scene;
  }

  check(result) {
    check(result, this.device);
  }

  /** Makes a geometry of a descriptor, attaches it, and returns its number. */
  add(kind, changes, vertexNumbers = -1) {
    const { address } = this;
    const geometry = withDescriptor(
      `kiwami_${kind}_desc`,
      native[`kiwami_${kind}_desc_init`],
      changes,
      (desc) =>
        receiveHandle((target) =>
          this.check(native[`kiwami_${kind}_create`](this.device, desc, target)),
        ),
    );
    const number = new Uint32Array(1);
    try {
      this.check(native.kiwami_scene_attach(address, geometry, number));
    } catch (problem) {
      native.kiwami_geometry_release(geometry);
      throw problem;
    }
    this.attached.set(number[0], { geometry, vertexNumbers });
    return number[0];
  }

  /** Adds a mesh, copied: three numbers a vertex, three a triangle. Returns the number that hits
   * report. Only a ray with (its mask & mask) !== 0 meets it. */
  addMesh(vertices, triangles, { mask = ALL_MASKS } = {}) {
    const [positions, vertexCount] = floats(vertices, 3, 'vertices');
    const triangleCount = rowsOf(triangles, 3, 'triangles');
    const changes = {
      vertices: addressable(positions),
      vertex_count: vertexCount,
      indices: addressable(typed(Uint32Array, triangles, 'triangles')),
      triangle_count: triangleCount,
      mask,
    };
    return this.add('triangle_mesh', changes, positions.length);
  }

  /** Adds a mesh whose vertices move from step to step: those of all steps, one step after the
   * other; times: when the mesh is where its first and its last step say. */
  addMovingMesh(vertices, stepCount, triangles, { times = [0, 1], mask = ALL_MASKS } = {}) {
    const columns = 3 * Math.max(stepCount, 1);
    const [positions, vertexCount] = floats(vertices, columns, 'vertices of all steps');
    const triangleCount = rowsOf(triangles, 3, 'triangles');
    const changes = {
      vertices: addressable(positions),
      vertex_count: vertexCount,
      indices: addressable(typed(Uint32Array, triangles, 'triangles')),
      triangle_count: triangleCount,
      step_count: stepCount,
      time_begin: times[0],
      time_end: times[1],
      mask,
    };
    return this.add('moving_mesh', changes);
  }

  /** Adds spheres: x, y, z and radius. */
  addSpheres(points, { mask = ALL_MASKS } = {}) {
    const [rows, count] = floats(points, 4, 'points');
    return this.add('spheres', { points: addressable(rows), sphere_count: count, mask });
  }

  /** Adds flat discs: x, y, z and radius, and a normal of three numbers each. */
  addDiscs(points, normals, { mask = ALL_MASKS } = {}) {
    const [rows, count] = floats(points, 4, 'points');
    requireRows(normals, 3, count, 'normals');
    const changes = {
      points: addressable(rows),
      normals: addressable(typed(Float32Array, normals, 'normals')),
      disc_count: count,
      mask,
    };
    return this.add('discs', changes);
  }

  /** Adds round curve segments: segment i joins the points segments[i] and segments[i] + 1. */
  addCurves(points, segments, { mask = ALL_MASKS } = {}) {
    const [rows, count] = floats(points, 4, 'points');
    const changes = {
      points: addressable(rows),
      point_count: count,
      indices: addressable(typed(Uint32Array, segments, 'segments')),
      segment_count: segments.length,
      mask,
    };
    return this.add('curves', changes);
  }

  /** Adds instances of these scenes. transforms: three rows of four numbers each, from the scene's
   * space to this one's; sceneIndices: which of the scenes each shows, else the first; masks: which
   * rays enter each, else all. A commit shows what the scenes have committed by then, and may not
   * overlap with theirs. */
  addInstances(scenes, transforms, { sceneIndices, masks, mask = ALL_MASKS } = {}) {
    const [rows, count] = floats(transforms, 12, 'transforms');
    const changes = {
      scenes: addressable(BigUint64Array.from(scenes, (scene) => addressOf(scene.address))),
      scene_count: scenes.length,
      transforms: addressable(rows),
      count,
      mask,
    };
    if (sceneIndices) {
      requireRows(sceneIndices, 1, count, 'sceneIndices');
      changes.scene_indices = addressable(typed(Uint32Array, sceneIndices, 'sceneIndices'));
    }
    if (masks) {
      requireRows(masks, 1, count, 'masks');
      changes.masks = addressable(typed(Uint32Array, masks, 'masks'));
    }
    return this.add('instances', changes);
  }

  /** Gives a mesh other vertices, as many as it has; refit() or commit() shows them. */
  updateVertices(geometryId, vertices) {
    const mesh = this.attached.get(geometryId);
    if (!mesh || mesh.vertexNumbers !== vertices.length) {
      throw new RangeError(`geometry ${geometryId} is no mesh of ${vertices.length} numbers`);
    }
    const positions = addressable(typed(Float32Array, vertices, 'vertices'));
    this.check(native.kiwami_triangle_mesh_update_vertices(mesh.geometry, positions, 0, 0));
  }

  /** Leaves a geometry out, or takes it in again, under its number. */
  enable(geometryId, isEnabled = true) {
    this.check(native.kiwami_scene_enable(this.address, geometryId, isEnabled ? 1 : 0));
  }

  /** Removes a geometry; its number becomes free. */
  remove(geometryId) {
    this.check(native.kiwami_scene_detach(this.address, geometryId));
    const removed = this.attached.get(geometryId);
    if (removed) native.kiwami_geometry_release(removed.geometry);
    this.attached.delete(geometryId);
  }
}

module.exports = { Geometries };
