// SPDX-License-Identifier: Apache-2.0
// Loads the shared library, and turns its results into exceptions.
'use strict';

const koffi = require('koffi');
const { constants, functions, structs } = require('./native');

/** An error of the library: its number as `result`, its sentence as the message. */
class KiwamiError extends Error {
  constructor(result, sentence) {
    super(sentence);
    this.name = 'KiwamiError';
    this.result = result;
  }
}

const types = {};
for (const [name, { size, fields }] of Object.entries(structs)) {
  types[name] = koffi.struct(name, fields);
  if (koffi.sizeof(types[name]) !== size) throw new Error(`${name} has an unexpected layout`);
}

const loaded = koffi.load(process.env.KIWAMI_LIBRARY || 'libkiwami.so.0');
const native = {};
for (const prototype of functions) {
  native[/(\w+)\(/.exec(prototype)[1]] = loaded.func(prototype);
}
if (native.kiwami_abi_version() !== constants.KIWAMI_ABI_VERSION) {
  throw new Error(
    `the Kiwami library has ABI version ${native.kiwami_abi_version()}, ` +
      `expected ${constants.KIWAMI_ABI_VERSION}`,
  );
}

/** Throws what a result stands for, unless it is success. */
function check(result, device = null) {
  if (result === constants.KIWAMI_OK) return;
  const text = Buffer.alloc(1024);
  native.kiwami_last_error(device, text, text.length);
  const sentence = text.toString('utf8', 0, text.indexOf(0));
  throw new KiwamiError(result, sentence || native.kiwami_result_name(result));
}

/** Calls body(descriptor, size) with a struct's default values, changed by these fields. */
function withDescriptor(name, init, changes, body) {
  const buffer = Buffer.alloc(structs[name].size);
  check(init(buffer, buffer.length));
  const fields = { ...koffi.decode(buffer, types[name]), ...changes };
  return body(koffi.as(fields, `${name} *`));
}

/** A struct that the library fills. */
function receiveStruct(name, body) {
  const buffer = Buffer.alloc(structs[name].size);
  buffer.writeUInt32LE(buffer.length, 0);
  body(buffer);
  return koffi.decode(buffer, types[name]);
}

/** Calls body(target), which has a handle written to target, and returns the handle. */
function receiveHandle(body) {
  const target = Buffer.alloc(8);
  body(target);
  return koffi.decode(target, 'void *');
}

module.exports = {
  KiwamiError,
  check,
  constants,
  native,
  receiveHandle,
  receiveStruct,
  withDescriptor,
};
