// SPDX-License-Identifier: Apache-2.0
// The answers that every binding must give, to the bit.
'use strict';

const assert = require('node:assert');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const test = require('node:test');
const { Device, Hits, KiwamiError, Rays, Scene, constants } = require('..');

const vectors = fs.readFileSync(path.join(__dirname, '../../conformance/vectors.txt'), 'utf8');

// Notes that features were found right, for the table of the documents.
function note(...features) {
  const file = process.env.KIWAMI_FEATURES;
  if (file) fs.appendFileSync(file, features.map((each) => `${each}\n`).join(''));
}

class Words {
  constructor(text) {
    this.words = text.split(/\s+/);
    this.next = 0;
  }
  word() {
    return this.words[this.next++];
  }
  number() {
    return Number(this.word());
  }
  numbers(count) {
    return Array.from({ length: count }, () => this.number());
  }
}

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
  const folder = path.join(__dirname, '../../conformance');
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

async function checkScene(words, device) {
  const scene = new Scene(device);
  words.word();
  let word = words.word();
  for (; word === 'mesh'; word = words.word()) {
    const [mask, vertexCount, triangleCount] = words.numbers(3);
    const bits = Uint32Array.from(words.numbers(3 * vertexCount));
    scene.addMesh(new Float32Array(bits.buffer), words.numbers(3 * triangleCount), { mask });
  }
  assert.strictEqual(word, 'rays');
  const rays = new Rays(words.number());
  rays.words.set(words.numbers(12 * rays.count));
  await scene.commit();
  assert.strictEqual(words.word(), 'closest_hit');
  assert.deepStrictEqual([...scene.closestHit(rays).words], words.numbers(9 * rays.count));
  assert.strictEqual(words.word(), 'any_hit');
  assert.deepStrictEqual([...scene.anyHit(rays)], words.numbers(rays.count));
  for (word = words.word(); word === 'multi_hit'; word = words.word()) {
    checkMultiHit(words, scene, rays);
  }
  if (word === 'file') {
    checkFile(words, device, scene, rays);
    word = words.word();
  }
  assert.strictEqual(word, 'end');
  note('closest hit', 'any hit', 'multi hit', 'counts');
  scene.close();
  return rays.count;
}

for (const isa of ['auto', 'scalar']) {
  test(`answers are the same to the bit: ${isa}`, async () => {
    const device = new Device({ isa, validate: true });
    const words = new Words(vectors);
    assert.strictEqual(words.word(), 'kiwami-conformance');
    assert.strictEqual(words.word(), '1');
    let compared = 0;
    while (words.word() === 'scene') compared += await checkScene(words, device);
    assert.ok(compared > 100);
    device.close();
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
