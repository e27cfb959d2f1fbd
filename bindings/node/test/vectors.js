// SPDX-License-Identifier: Apache-2.0
// Reads the conformance vectors.
'use strict';

const fs = require('node:fs');
const path = require('node:path');

const folder = path.join(__dirname, '../../conformance');
const read = (name) => fs.readFileSync(path.join(folder, `${name}.txt`), 'utf8');

// Notes that features were found right, for the table of the documents.
function note(...features) {
  const file = process.env.KIWAMI_FEATURES;
  if (file) fs.appendFileSync(file, features.map((each) => `${each}\n`).join(''));
}

class Words {
  constructor(text) {
    this.words = text.trim().split(/\s+/);
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
  floats(count) {
    return new Float32Array(Uint32Array.from(this.numbers(count)).buffer);
  }
}

module.exports = { Words, folder, note, read };
