// SPDX-License-Identifier: Apache-2.0
// The answers that every binding must give, to the bit.
'use strict';

const assert = require('node:assert');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const test = require('node:test');
const { Device, Hits, KiwamiError, Rays, Scene, constants } = require('..');

const { Words, folder, note, read } = require('./vectors');

const vectors = read('vectors');

function checkMultiHit(words, scene, rays) {
  const maxHits = words.number();
  const total = words.number();
  const found = scene.multiHit(rays, maxHits);
  assert.deepStrictEqual([...found.offsets], words.numbers(rays.count + 1));
  assert.strictEqual(found.hits.count, total);
  assert.deepStrictEqual([...found.hits.words.subarray(0, 9 * total)], words.numbers(9 * total));
  scene.countHits(rays).forEach((count, i) => {
    const expected = maxHits === 0 ? count : Math.min(count, maxHits);
    assert.strictEqual(found.offsets[i + 1] - found.offsets[i], expected);
  });
}

function checkFile(words, device, scene, rays) {
  const saved = path.join(os.tmpdir(), `kiwami-${process.pid}.kiwami`);
  scene.save(saved);
  const expected = scene.closestHit(rays).words;
  for (const file of [saved, path.join(folder, words.word())]) {
    for (const map of [false, true]) {
      const loaded = Scene.load(file, { device, map, trusted: map });
      assert.deepStrictEqual(loaded.closestHit(rays).words, expected);
      loaded.close();
    }
  }
  fs.unlinkSync(saved);
  assert.throws(() => Scene.load(path.join(folder, 'vectors.txt')), KiwamiError);
  note('files');
}

// Adds a geometry, by its kind.
const geometries = {
  mesh(words, scene) {
    const [mask, vertexCount, triangleCount] = words.numbers(3);
    const vertices = words.floats(3 * vertexCount);
    scene.addMesh(vertices, words.numbers(3 * triangleCount), { mask });
  },
  moving_mesh(words, scene) {
    const [mask, steps] = words.numbers(2);
    const times = [...words.floats(2)];
    const [vertexCount, triangleCount] = words.numbers(2);
    const vertices = words.floats(3 * steps * vertexCount);
    scene.addMovingMesh(vertices, steps, words.numbers(3 * triangleCount), { times, mask });
  },
  spheres(words, scene) {
    const [mask, count] = words.numbers(2);
    scene.addSpheres(words.floats(4 * count), { mask });
  },
  discs(words, scene) {
    const [mask, count] = words.numbers(2);
    const points = words.floats(4 * count);
    scene.addDiscs(points, words.floats(3 * count), { mask });
  },
  curves(words, scene) {
    const [mask, pointCount, segmentCount] = words.numbers(3);
    const points = words.floats(4 * pointCount);
    scene.addCurves(points, words.numbers(segmentCount), { mask });
  },
  instances(words, scene, scenes) {
    const [mask, sceneCount, count] = words.numbers(3);
    const shown = Array.from({ length: sceneCount }, () => scenes.get(words.word()));
    const [sceneIndices, masks, transforms] = [[], [], []];
    for (let i = 0; i < count; ++i) {
      sceneIndices.push(words.number());
      masks.push(words.number());
      transforms.push(...words.floats(12));
    }
    scene.addInstances(shown, transforms, { sceneIndices, masks, mask });
  },
};

// Changes the scene, or compares answers, by the word of the statement.
const statements = {
  commit: (words, state) => state.scene.commit(),
  refit: (words, state) => state.scene.refit(),
  vertices(words, { scene }) {
    const [geometryId, count] = words.numbers(2);
    scene.updateVertices(geometryId, words.floats(3 * count));
  },
  enable(words, { scene }) {
    const [geometryId, isEnabled] = words.numbers(2);
    scene.enable(geometryId, isEnabled !== 0);
  },
  remove: (words, { scene }) => scene.remove(words.number()),
  rays(words, state) {
    state.rays = new Rays(words.number());
    state.rays.words.set(words.numbers(12 * state.rays.count));
    state.compared += state.rays.count;
  },
  closest_hit(words, { scene, rays }) {
    assert.deepStrictEqual([...scene.closestHit(rays).words], words.numbers(9 * rays.count));
  },
  any_hit(words, { scene, rays }) {
    assert.deepStrictEqual([...scene.anyHit(rays)], words.numbers(rays.count));
  },
  multi_hit: (words, { scene, rays }) => checkMultiHit(words, scene, rays),
  file: (words, { device, scene, rays }) => checkFile(words, device, scene, rays),
};

// Returns how many rays were compared.
async function checkScene(words, device, scenes) {
  const state = { device, scene: new Scene(device), rays: null, compared: 0 };
  scenes.set(words.word(), state.scene);
  for (let word = words.word(); word !== 'end'; word = words.word()) {
    if (word in geometries) geometries[word](words, state.scene, scenes);
    else await statements[word](words, state);
  }
  return state.compared;
}

const files = {
  vectors: ['closest hit', 'any hit', 'multi hit', 'counts'],
  shapes: ['spheres, discs, curves'],
  moving_meshes: ['moving meshes'],
  instances: ['instances'],
  changes: ['changes, refit'],
};
for (const [name, features] of Object.entries(files)) {
  test(`answers are the same to the bit: ${name}`, async () => {
    for (const isa of ['auto', 'scalar']) {
      const device = new Device({ isa, validate: true });
      const scenes = new Map();
      const words = new Words(read(name));
      assert.strictEqual(words.word(), 'kiwami-conformance');
      assert.strictEqual(words.word(), '1');
      let compared = 0;
      while (words.word() === 'scene') compared += await checkScene(words, device, scenes);
      assert.ok(compared > 100);
      for (const scene of scenes.values()) scene.close();
      device.close();
    }
    note(...features);
  });
}

test('errors are the same', () => {
  const scene = new Scene();
  const calls = {
    index_beyond_vertices: () => scene.addMesh([0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, 3]),
    unknown_geometry: () => scene.remove(5),
    parameter_out_of_bounds: () => scene.setParameter(constants.KIWAMI_PARAMETER_BIN_COUNT, 1000),
    not_committed: () => scene.closestHit(new Rays(1)),
  };
  const lines = vectors.split('\n').filter((line) => line.startsWith('error '));
  assert.strictEqual(lines.length, Object.keys(calls).length);
  for (const line of lines) {
    const [, name, result] = line.split(' ', 3);
    assert.throws(calls[name], (error) => {
      assert.ok(error instanceof KiwamiError);
      assert.strictEqual(`error ${name} ${error.result} ${error.message}`, line);
      return result === String(error.result);
    });
  }
  note('errors');
});

test('misuse is an exception', () => {
  const device = new Device();
  const scene = new Scene(device);
  device.close();
  device.close();
  assert.throws(() => new Device({ isa: 'mmx' }), RangeError);
  assert.throws(() => scene.addMesh([0, 0], [0, 1, 2]), RangeError);
  assert.throws(() => scene.addMesh([0, 0, 0], [0, -1, 0]), /holds -1/);
  assert.throws(() => Rays.from([0, 0, 0], [1, 0]), RangeError);
  scene.commitSync();
  assert.throws(() => scene.closestHit(new Rays(2), new Hits(1)), RangeError);
  assert.strictEqual(scene.closestHit(new Rays(0)).count, 0);
  scene.close();
  scene.close();
  assert.throws(() => scene.commitSync(), /closed/);
});

test('rays are made from arrays', () => {
  const scene = new Scene();
  scene.addMesh([0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, 2]);
  scene.commitSync();
  const rays = Rays.from([0.25, 0.25, -1, 5, 5, 5], [0, 0, 1, 0, 0, 1]);
  const hits = scene.closestHit(rays);
  assert.strictEqual(hits.t(0), 1);
  assert.deepStrictEqual([hits.u(0), hits.v(0), ...hits.normal(0)], [0.25, 0.25, 0, 0, 1]);
  assert.deepStrictEqual([hits.isHit(0), hits.isHit(1)], [true, false]);
});

test('a promise fails with the sentence of the library', async () => {
  const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0];
  const device = new Device();
  const scenes = [0, 1].map(() => new Scene(device));
  for (const scene of scenes) scene.addInstances([new Scene(device)], identity);
  let sentence;
  assert.throws(() => scenes[0].commitSync(), (problem) => {
    sentence = problem.message;
    return problem instanceof KiwamiError && sentence.length > 30;
  });
  // Also while other calls fail: at the same time, and here.
  const settled = Promise.allSettled(scenes.map((scene) => scene.commit()));
  assert.throws(() => new Scene(device).remove(5), /5/);
  for (const { reason } of await settled) {
    assert.ok(reason instanceof KiwamiError);
    assert.strictEqual(reason.message, sentence);
  }
  scenes[0].remove(0);
  const promise = scenes[0].commit();
  assert.throws(() => scenes[0].close(), /being committed/);
  assert.throws(() => scenes[0].closestHit(new Rays(1)), /being committed/);
  await promise;
  assert.strictEqual(scenes[0].closestHit(new Rays(1)).isHit(0), false);
});

test('geometries of wrong sizes are exceptions', () => {
  const scene = new Scene();
  assert.throws(() => scene.addDiscs([0, 0, 0, 1], []), RangeError);
  assert.throws(() => scene.addMovingMesh(new Float32Array(9), 2, []), RangeError);
  assert.throws(() => scene.addMovingMesh(new Float32Array(9), 0, []), KiwamiError);
  assert.throws(() => scene.addInstances([], new Float32Array(12)), KiwamiError);
  const other = new Scene();
  const bad = { sceneIndices: [0, 0] };
  assert.throws(() => scene.addInstances([other], new Float32Array(12), bad), RangeError);
  assert.throws(() => scene.updateVertices(0, [0, 0, 0]), RangeError);
  scene.commitSync();
  scene.close();
  other.close();
});
