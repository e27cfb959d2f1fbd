// SPDX-License-Identifier: Apache-2.0
// Sets of lights against the answers that every binding must give.
'use strict';

const assert = require('node:assert');
const test = require('node:test');
const { Device, KiwamiError, LightReceivers, LightTree, constants } = require('..');
const { Words, note, read } = require('./vectors');

const KINDS = ['point', 'spot', 'triangle', 'quad', 'sphere', 'disc', 'distant', 'environment'];

/** A buffer of words. */
const bytes = (words) => Buffer.from(Uint32Array.from(words).buffer);

function readLight(words) {
  const [kind, flags] = words.numbers(2);
  const points = [...words.floats(12)];
  const direction = [...words.floats(3)];
  const [radius, cosInner, cosOuter, power] = words.floats(4);
  const userId = words.number();
  const linkMask = bytes(words.numbers(2)).readBigUInt64LE();
  const twoSided = flags !== 0;
  return {
    kind: KINDS[kind], twoSided, points, direction, radius, cosInner, cosOuter, power, userId,
    linkMask,
  };
}

// Changes the set, or compares choices, by the word of the statement.
const statements = {
  light(words, { lights }) {
    const count = words.number();
    lights.addLights(Array.from({ length: count }, () => readLight(words)));
  },
  light_mesh(words, { lights }) {
    const twoSided = words.number() !== 0;
    const [radiance] = words.floats(1);
    const [vertexCount, triangleCount] = words.numbers(2);
    const vertices = words.floats(3 * vertexCount);
    lights.addMesh(vertices, words.numbers(3 * triangleCount), { radiance, twoSided });
  },
  powers(words, { lights }) {
    const [first, count] = words.numbers(2);
    lights.setPowers(first, words.floats(count));
  },
  commit: (words, { lights }) => lights.commit(),
  refit: (words, { lights }) => lights.refit(),
  receivers(words, state) {
    state.receivers = new LightReceivers(words.number());
    bytes(words.numbers(14 * state.receivers.count)).copy(state.receivers.buffer);
  },
  choices(words, state) {
    state.choices = state.lights.sample(state.receivers);
    const expected = bytes(words.numbers(6 * state.choices.count));
    assert.ok(state.choices.buffer.equals(expected));
    state.compared += state.choices.count;
  },
  pdf(words, { lights, receivers, choices }) {
    const found = lights.pdf(receivers, choices);
    assert.deepStrictEqual([...found], [...words.floats(receivers.count)]);
  },
};

for (const isa of ['auto', 'scalar']) {
  test(`choices are the same to the bit: ${isa}`, () => {
    const device = new Device({ isa, validate: true });
    const words = new Words(read('lights'));
    assert.strictEqual(words.word(), 'kiwami-conformance');
    assert.strictEqual(words.word(), '1');
    let compared = 0;
    while (words.word() === 'lights') {
      const lights = new LightTree(device, { width: words.number() });
      const state = { lights, compared: 0 };
      for (let word = words.word(); word !== 'end'; word = words.word()) {
        statements[word](words, state);
      }
      compared += state.compared;
      lights.close();
    }
    assert.ok(compared > 100);
    note('many lights');
  });
}

test('bad lights are exceptions', () => {
  const device = new Device();
  assert.throws(() => new LightTree(device, { width: 3 }), KiwamiError);
  const lights = new LightTree(device);
  device.close();
  const receivers = LightReceivers.from([0, 0, 0], [0, 0, 1], [0.5]);
  assert.throws(() => lights.sample(receivers), KiwamiError);
  assert.throws(() => lights.addLights([{ kind: 'lamp' }]), /lamp/);
  assert.throws(() => lights.addLights([{ power: -1 }]), KiwamiError);
  assert.throws(() => lights.addMesh([0, 0], []), RangeError);
  assert.throws(() => lights.setPowers(0, [1]), KiwamiError);
  assert.strictEqual(lights.addLights([{ points: [0, 0, 1], userId: 7 }]), 0);
  lights.commit();
  const choices = lights.sample(receivers);
  assert.deepStrictEqual(
    [choices.lightId(0), choices.instanceId(0), choices.userId(0), choices.probability(0)],
    [0, constants.KIWAMI_INVALID_ID, 7, 1],
  );
  assert.ok(choices.random(0) >= 0 && choices.random(0) < 1);
  assert.throws(() => lights.pdf(new LightReceivers(2), choices), RangeError);
  lights.close();
  assert.throws(() => lights.commit(), /closed/);
});
