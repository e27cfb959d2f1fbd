// SPDX-License-Identifier: Apache-2.0
// Objects of the library, and arrays on their way to it.
'use strict';

const ALL_MASKS = 0xffffffff;

const released = new FinalizationRegistry((release) => release());

/** Owns one reference to an object of the library. */
class Handle {
  constructor(object, release) {
    this.object = object;
    this.isBusy = false;
    this.release = () => release(object);
    released.register(this, this.release, this);
  }

  /** The object for a call. */
  get address() {
    if (!this.object) throw new Error(`this ${this.constructor.name} is closed`);
    this.requireIdle();
    return this.object;
  }

  /** Nothing may be done while another thread works on the object. */
  requireIdle() {
    if (this.isBusy) throw new Error(`this ${this.constructor.name} is being committed`);
  }

  /** Lets go of the object at once. Closing twice is allowed. */
  close() {
    if (!this.object) return;
    this.requireIdle();
    this.object = null;
    released.unregister(this);
    this.release();
  }
}

/** An address for an array that may be empty: the library takes null only where nothing is. */
const addressable = (array) => (array.length ? array : new Uint8Array(1));

/** How many rows of so many numbers there are. */
function rowsOf(values, columns, name) {
  if (values.length % columns !== 0) {
    throw new RangeError(`${name} has ${values.length} numbers, expected a multiple of ${columns}`);
  }
  return values.length / columns;
}

/** Numbers as an array of this kind: itself if it is one, else a copy whose values are checked. */
function typed(Kind, values, name) {
  if (values instanceof Kind) return values;
  const array = Kind.from(values);
  const isKept = (value, i) => Kind !== Uint32Array || value === array[i];
  const changed = Array.prototype.findIndex.call(values, (value, i) => !isKept(value, i));
  if (changed >= 0) {
    throw new RangeError(`${name} holds ${values[changed]}, expected whole numbers from 0 on`);
  }
  return array;
}

module.exports = { ALL_MASKS, Handle, addressable, rowsOf, typed };
