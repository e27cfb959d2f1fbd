// SPDX-License-Identifier: Apache-2.0
// Loads the shared library, and turns its results into exceptions.
'use strict';

const koffi = require('koffi');
const { callbacks, constants, functions, structs } = require('./native');

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

// A sentence can be asked for on the thread alone where the call failed, which for an asynchronous
// call is one of Node's own. But the library logs it, too, and koffi brings that here.
let runningCalls = 0;
let logged = [];

/** Where devices log: a function of the process, which never ends. */
const log = koffi.register((user, result, sentence) => {
  if (runningCalls === 0 || result === constants.KIWAMI_OK) return;
  logged.push({ result, sentence: koffi.decode(sentence, 'char', -1) });
}, koffi.pointer(koffi.proto(callbacks.find((each) => each.includes(' kiwami_log(')))));

/** The first sentence of this kind that was logged, which is then gone. */
function takeLogged(isIt) {
  const index = logged.findIndex(isIt);
  return index < 0 ? undefined : logged.splice(index, 1)[0].sentence;
}

/** Throws what a result stands for, unless it is success. */
function check(result, device = null) {
  if (result === constants.KIWAMI_OK) return;
  const text = Buffer.alloc(1024);
  native.kiwami_last_error(device, text, text.length);
  const sentence = text.toString('utf8', 0, text.indexOf(0));
  takeLogged((each) => each.sentence === sentence);
  throw new KiwamiError(result, sentence || native.kiwami_result_name(result));
}

/** Runs a function of the library on another thread for its owner, which nothing else may use until
 * then; the promise fails as check() does. */
function callAsync(call, owner) {
  const { address } = owner;
  ++runningCalls;
  owner.isBusy = true;
  return new Promise((resolve, reject) => {
    call.async(address, (problem, result) => {
      owner.isBusy = false; // and the owner has lived until here
      const sentence = takeLogged((each) => each.result === result);
      if (--runningCalls === 0) logged = [];
      if (problem) reject(problem);
      else if (result === constants.KIWAMI_OK) resolve();
      else reject(new KiwamiError(result, sentence || native.kiwami_result_name(result)));
    });
  });
}

/** The number of an object's address. */
const addressOf = (object) => koffi.address(object);

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
  addressOf,
  callAsync,
  check,
  constants,
  log,
  native,
  receiveHandle,
  receiveStruct,
  withDescriptor,
};
