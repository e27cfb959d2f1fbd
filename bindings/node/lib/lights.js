// SPDX-License-Identifier: Apache-2.0
// Many lights: which of them a point should ask.
'use strict';

const { Handle, addressable, rowsOf, typed } = require('./handle');
const { check, constants, native, receiveHandle, withDescriptor } = require('./library');
const { structs } = require('./native');

const KINDS = {
  point: constants.KIWAMI_LIGHT_POINT,
  spot: constants.KIWAMI_LIGHT_SPOT,
  triangle: constants.KIWAMI_LIGHT_TRIANGLE,
  quad: constants.KIWAMI_LIGHT_QUAD,
  sphere: constants.KIWAMI_LIGHT_SPHERE,
  disc: constants.KIWAMI_LIGHT_DISC,
  distant: constants.KIWAMI_LIGHT_DISTANT,
  environment: constants.KIWAMI_LIGHT_ENVIRONMENT,
};
const ALL_LINKS = 2n ** 64n - 1n;
const LIGHT_BYTES = structs.kiwami_light.size;
const RECEIVER_BYTES = structs.kiwami_light_receiver.size;
const CHOICE_BYTES = structs.kiwami_light_choice.size;

/** Writes one light into a buffer: see kiwami_light of light.h. */
function writeLight(buffer, at, light) {
  const { kind = 'point', points = [], direction = [0, 0, 0] } = light;
  if (!(kind in KINDS)) {
    throw new RangeError(`kind is '${kind}', expected one of ${Object.keys(KINDS).join(', ')}`);
  }
  buffer.writeUInt32LE(KINDS[kind], at);
  buffer.writeUInt32LE(light.twoSided ? constants.KIWAMI_LIGHT_TWO_SIDED : 0, at + 4);
  for (let i = 0; i < Math.min(points.length, 12); ++i) {
    buffer.writeFloatLE(points[i], at + 8 + 4 * i);
  }
  for (let i = 0; i < 3; ++i) buffer.writeFloatLE(direction[i], at + 56 + 4 * i);
  buffer.writeFloatLE(light.radius ?? 0, at + 68);
  buffer.writeFloatLE(light.cosInner ?? 1, at + 72);
  buffer.writeFloatLE(light.cosOuter ?? 1, at + 76);
  buffer.writeFloatLE(light.power ?? 1, at + 80);
  buffer.writeUInt32LE(light.userId ?? 0, at + 84);
  buffer.writeBigUInt64LE(light.linkMask ?? ALL_LINKS, at + 88);
}

/** Who asks for lights, in one buffer: 56 bytes a receiver, as kiwami_light_receiver of light.h. */
class LightReceivers {
  /** Points without a normal, which every light may reach. */
  constructor(count) {
    this.count = count;
    this.buffer = Buffer.alloc(count * RECEIVER_BYTES);
    for (let i = 0; i < count; ++i) this.setLinkMask(i, ALL_LINKS);
  }

  /** Points of positions and normals (or null), three numbers each; random: one each, from 0 to 1. */
  static from(positions, normals, random) {
    const receivers = new LightReceivers(rowsOf(positions, 3, 'positions'));
    for (let i = 0; i < receivers.count; ++i) {
      receivers.setPosition(i, positions.slice(3 * i, 3 * i + 3));
      if (normals) receivers.setNormal(i, normals.slice(3 * i, 3 * i + 3));
      receivers.setRandom(i, random[i]);
    }
    return receivers;
  }

  setFloats(receiver, offset, values) {
    const at = receiver * RECEIVER_BYTES + offset;
    for (let i = 0; i < 3; ++i) this.buffer.writeFloatLE(values[i], at + 4 * i);
  }
  setPosition(receiver, position) {
    this.setFloats(receiver, 0, position);
  }
  setNormal(receiver, normal) {
    this.setFloats(receiver, 12, normal);
  }
  /** From the position to the other end of a segment. */
  setSegment(receiver, segment) {
    this.setFloats(receiver, 24, segment);
  }
  /** KIWAMI_RECEIVER_*, found in `constants`. */
  setFlags(receiver, flags) {
    this.buffer.writeUInt32LE(flags, receiver * RECEIVER_BYTES + 36);
  }
  setLinkMask(receiver, linkMask) {
    this.buffer.writeBigUInt64LE(linkMask, receiver * RECEIVER_BYTES + 40);
  }
  setRandom(receiver, random) {
    this.buffer.writeDoubleLE(random, receiver * RECEIVER_BYTES + 48);
  }
}

/** Lights that were chosen, in one buffer: 24 bytes a choice. */
class LightChoices {
  constructor(count) {
    this.count = count;
    this.buffer = Buffer.alloc(count * CHOICE_BYTES);
  }
  /** constants.KIWAMI_INVALID_ID: none. */
  lightId(choice) {
    return this.buffer.readUInt32LE(choice * CHOICE_BYTES);
  }
  /** The instance through which the light is seen; constants.KIWAMI_INVALID_ID: none. */
  instanceId(choice) {
    return this.buffer.readUInt32LE(choice * CHOICE_BYTES + 4);
  }
  userId(choice) {
    return this.buffer.readUInt32LE(choice * CHOICE_BYTES + 8);
  }
  /** With which this choice was made. */
  probability(choice) {
    return this.buffer.readFloatLE(choice * CHOICE_BYTES + 12);
  }
  /** A new random number, for a point on the light. */
  random(choice) {
    return this.buffer.readDoubleLE(choice * CHOICE_BYTES + 16);
  }
}

/** Lights, among which points choose in proportion to what may reach them. Changes take effect with
 * commit() or refit(). */
class LightTree extends Handle {
  /** width: children of a node: 2, 4, 8 or 16; 0: the device's default. */
  constructor(device, { width = 0 } = {}) {
    const held = device.address;
    const object = withDescriptor(
      'kiwami_light_tree_desc',
      native.kiwami_light_tree_desc_init,
      { width },
      (desc) =>
        receiveHandle((target) =>
          check(native.kiwami_light_tree_create(held, desc, target), held),
        ),
    );
    native.kiwami_device_retain(held);
    super(object, (tree) => {
      native.kiwami_light_tree_release(tree);
      native.kiwami_device_release(held);
    });
    this.device = held;
  }

  check(result) {
    check(result, this.device);
  }

  /** Adds lights; returns the number of the first. */
  addLights(lights) {
    const buffer = Buffer.alloc(Math.max(lights.length, 1) * LIGHT_BYTES);
    lights.forEach((light, i) => writeLight(buffer, i * LIGHT_BYTES, light));
    const first = new Uint32Array(1);
    this.check(
      native.kiwami_light_tree_add_lights(this.address, buffer, 0, lights.length, first),
    );
    return first[0];
  }

  /** Makes a light of each triangle; returns the number of the first. */
  addMesh(vertices, triangles, { radiance = 1, twoSided = false } = {}) {
    const changes = {
      flags: twoSided ? constants.KIWAMI_LIGHT_TWO_SIDED : 0,
      vertices: addressable(typed(Float32Array, vertices, 'vertices')),
      vertex_count: rowsOf(vertices, 3, 'vertices'),
      indices: addressable(typed(Uint32Array, triangles, 'triangles')),
      triangle_count: rowsOf(triangles, 3, 'triangles'),
      radiance,
    };
    const first = new Uint32Array(1);
    withDescriptor(
      'kiwami_light_mesh_desc',
      native.kiwami_light_mesh_desc_init,
      changes,
      (desc) => this.check(native.kiwami_light_tree_add_mesh(this.address, desc, first)),
    );
    return first[0];
  }

  /** Gives the lights from first on other powers. */
  setPowers(first, powers) {
    const values = addressable(typed(Float32Array, powers, 'powers'));
    this.check(
      native.kiwami_light_tree_set_powers(this.address, first, values, 0, powers.length),
    );
  }

  /** Builds the tree over all lights. */
  commit() {
    this.check(native.kiwami_light_tree_commit(this.address));
  }

  /** As commit(), but keeps the shape of the tree. */
  refit() {
    this.check(native.kiwami_light_tree_refit(this.address));
  }

  /** Lets each receiver choose a light. */
  sample(receivers) {
    const choices = new LightChoices(receivers.count);
    this.check(
      native.kiwami_light_sample(
        this.address, addressable(receivers.buffer), 0, addressable(choices.buffer), 0,
        receivers.count, null,
      ),
    );
    return choices;
  }

  /** The probability with which each receiver chooses the light of the choice beside it. */
  pdf(receivers, choices) {
    if (choices.count !== receivers.count) {
      throw new RangeError(`there are ${choices.count} choices, expected ${receivers.count}`);
    }
    const probabilities = new Float32Array(receivers.count);
    // A choice begins with the name of its light.
    this.check(
      native.kiwami_light_pdf(
        this.address, addressable(receivers.buffer), 0, addressable(choices.buffer), CHOICE_BYTES,
        addressable(probabilities), 0, receivers.count, null,
      ),
    );
    return probabilities;
  }
}

module.exports = { LightChoices, LightReceivers, LightTree };
