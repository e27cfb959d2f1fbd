// SPDX-License-Identifier: Apache-2.0
// Kiwami for Node: ray tracing on CPUs, in batches of typed arrays.
'use strict';

const { Geometries } = require('./geometries');
const { ALL_MASKS, Handle, addressable } = require('./handle');
const { LightChoices, LightReceivers, LightTree } = require('./lights');
const {
  KiwamiError,
  callAsync,
  check,
  constants,
  log,
  native,
  receiveHandle,
  receiveStruct,
  withDescriptor,
} = require('./library');

const ISAS = {
  auto: constants.KIWAMI_ISA_AUTO,
  scalar: constants.KIWAMI_ISA_SCALAR,
  sse: constants.KIWAMI_ISA_SSE,
  avx2: constants.KIWAMI_ISA_AVX2,
  avx512: constants.KIWAMI_ISA_AVX512,
};
const RAY_WORDS = 12;
const HIT_WORDS = 9;

/** Kernels of one instruction set and the threads that run them. */
class Device extends Handle {
  constructor({ isa = 'auto', threads = 0, validate = false } = {}) {
    if (!(isa in ISAS)) {
      throw new RangeError(`isa is '${isa}', expected one of ${Object.keys(ISAS).join(', ')}`);
    }
    const changes = {
      isa: ISAS[isa],
      thread_count: threads,
      flags: validate ? constants.KIWAMI_DEVICE_VALIDATE : 0,
      log,
    };
    const object = withDescriptor(
      'kiwami_device_desc',
      native.kiwami_device_desc_init,
      changes,
      (desc) => receiveHandle((target) => check(native.kiwami_device_create(desc, target))),
    );
    super(object, native.kiwami_device_release);
  }

  /** The name of the instruction set whose kernels run. */
  get isa() {
    const info = receiveStruct('kiwami_device_info', (target) =>
      check(native.kiwami_device_get_info(this.address, target), this.address),
    );
    return native.kiwami_isa_name(info.isa);
  }
}

/** Rays in one typed array, which the library reads where it lies: 12 words a ray. */
class Rays {
  constructor(count) {
    this.count = count;
    this.floats = new Float32Array(count * RAY_WORDS);
    this.words = new Uint32Array(this.floats.buffer);
    for (let i = 0; i < count; ++i) {
      this.floats[i * RAY_WORDS + 7] = Infinity;
      this.words[i * RAY_WORDS + 9] = ALL_MASKS;
    }
  }

  /** Rays of origins and directions, three numbers each; tmin, tmax and mask hold for all. */
  static from(origins, directions, { tmin = 0, tmax = Infinity, mask = ALL_MASKS } = {}) {
    if (origins.length !== directions.length || origins.length % 3 !== 0) {
      throw new RangeError(
        `origins has ${origins.length} and directions ${directions.length} numbers, ` +
          'expected the same multiple of 3',
      );
    }
    const rays = new Rays(origins.length / 3);
    for (let i = 0; i < rays.count; ++i) {
      rays.set(i, origins.slice(3 * i, 3 * i + 3), directions.slice(3 * i, 3 * i + 3), tmin, tmax);
      rays.words[i * RAY_WORDS + 9] = mask;
    }
    return rays;
  }

  set(ray, origin, direction, tmin = 0, tmax = Infinity) {
    const first = ray * RAY_WORDS;
    this.floats.set(origin, first);
    this.floats[first + 3] = tmin;
    this.floats.set(direction, first + 4);
    this.floats[first + 7] = tmax;
  }
}

/** Answers in one typed array, which the library writes where it lies: 9 words a hit. */
class Hits {
  constructor(count) {
    this.count = count;
    this.floats = new Float32Array(count * HIT_WORDS);
    this.words = new Uint32Array(this.floats.buffer);
  }
  /** Distance in units of the direction's length; Infinity for a miss. */
  t(hit) {
    return this.floats[hit * HIT_WORDS];
  }
  /** The point is (1 - u - v) a + u b + v c. */
  u(hit) {
    return this.floats[hit * HIT_WORDS + 1];
  }
  v(hit) {
    return this.floats[hit * HIT_WORDS + 2];
  }
  /** (b - a) x (c - a), not normalised. */
  normal(hit) {
    return this.floats.slice(hit * HIT_WORDS + 3, hit * HIT_WORDS + 6);
  }
  primitiveId(hit) {
    return this.words[hit * HIT_WORDS + 6];
  }
  geometryId(hit) {
    return this.words[hit * HIT_WORDS + 7];
  }
  instanceId(hit) {
    return this.words[hit * HIT_WORDS + 8];
  }
  isHit(hit) {
    return this.primitiveId(hit) !== constants.KIWAMI_INVALID_ID;
  }
}

/** Meshes under one acceleration structure. Changes take effect with commit(). */
class Scene extends Geometries {
  /** An empty scene. */
  constructor(device = new Device()) {
    const object = receiveHandle((target) =>
      check(native.kiwami_scene_create(device.address, target), device.address),
    );
    const held = device.address;
    native.kiwami_device_retain(held);
    super(object, held);
  }

  /** Saves the committed scene; a file of that name stays whole until all is written. */
  save(path) {
    withDescriptor('kiwami_save_desc', native.kiwami_save_desc_init, { path }, (desc) =>
      this.check(native.kiwami_scene_save(this.address, desc, null)),
    );
  }

  /** Loads a scene that save() wrote. map: use the file where it lies, which may not change;
   * trusted: check nothing, for files that nobody else could change. */
  static load(path, { device = new Device(), map = false, trusted = false } = {}) {
    const scene = new Scene(device);
    const flags =
      (map ? constants.KIWAMI_LOAD_MAP : 0) | (trusted ? constants.KIWAMI_LOAD_TRUSTED : 0);
    const loaded = withDescriptor(
      'kiwami_load_desc',
      native.kiwami_load_desc_init,
      { path, flags },
      (desc) =>
        receiveHandle((target) => scene.check(native.kiwami_scene_load(scene.device, desc, target))),
    );
    scene.replace(loaded);
    return scene;
  }

  /** Sets one of KIWAMI_PARAMETER_*, found in `constants`. */
  setParameter(parameter, value) {
    this.check(native.kiwami_scene_set_parameter(this.address, parameter, value));
  }

  /** Builds the acceleration structure on another thread; using the scene before the
   * promise is settled is an error. */
  commit() {
    return callAsync(native.kiwami_scene_commit, this);
  }

  /** The same on this thread. */
  commitSync() {
    this.check(native.kiwami_scene_commit(this.address));
  }

  /** As commit(), but keeps the tree where only vertices moved: quicker to make, and, the further
   * they moved, slower to trace. */
  refit() {
    return callAsync(native.kiwami_scene_refit, this);
  }

  /** The same on this thread. */
  refitSync() {
    this.check(native.kiwami_scene_refit(this.address));
  }

  /** The closest hit of each ray; into hits, if they are given. */
  closestHit(rays, hits = new Hits(rays.count)) {
    if (hits.count !== rays.count) {
      throw new RangeError(`hits has room for ${hits.count}, expected ${rays.count}`);
    }
    const { address } = this;
    this.check(
      native.kiwami_closest_hit(
        address, addressable(rays.floats), 0, addressable(hits.floats), 0, rays.count, null,
      ),
    );
    return hits;
  }

  /** 1 for each ray that has a hit, 0 for the others. */
  anyHit(rays, occluded = new Uint8Array(rays.count)) {
    if (occluded.length !== rays.count) {
      throw new RangeError(`occluded has room for ${occluded.length}, expected ${rays.count}`);
    }
    this.check(
      native.kiwami_any_hit(
        this.address, addressable(rays.floats), 0, addressable(occluded), 0, rays.count, null,
      ),
    );
    return occluded;
  }

  /** The nearest maxHits hits of each ray, by rising distance; 0 stands for all. Those of ray i
   * are hits offsets[i] to offsets[i + 1] - 1. */
  multiHit(rays, maxHits = 0) {
    const offsets = new BigUint64Array(rays.count + 1);
    let hits = new Hits(rays.count);
    for (;;) {
      const result = native.kiwami_multi_hit(
        this.address, addressable(rays.floats), 0, rays.count, maxHits, addressable(hits.floats),
        hits.count, offsets, null,
      );
      const needed = Number(offsets[rays.count]);
      if (result !== constants.KIWAMI_ERROR_CAPACITY) {
        this.check(result);
        hits.count = needed;
        return { offsets: Float64Array.from(offsets, Number), hits };
      }
      hits = new Hits(needed);
    }
  }

  /** How many hits each ray has. */
  countHits(rays, counts = new Uint32Array(rays.count)) {
    this.check(
      native.kiwami_count_hits(
        this.address, addressable(rays.floats), 0, addressable(counts), 0, rays.count, null,
      ),
    );
    return counts;
  }
}

module.exports = {
  Device,
  Hits,
  KiwamiError,
  LightChoices,
  LightReceivers,
  LightTree,
  Rays,
  Scene,
  constants,
};
