// SPDX-License-Identifier: Apache-2.0
// See bindings/benchmark/trace_file.c.
'use strict';

const fs = require('node:fs');
const { Hits, Rays, Scene } = require('..');

const [scenePath, raysPath, rounds] = process.argv.slice(2);
const bytes = fs.readFileSync(raysPath);
const rays = new Rays(bytes.length / 48);
new Uint8Array(rays.floats.buffer).set(bytes);
const scene = Scene.load(scenePath, { map: true, trusted: true });
const hits = new Hits(rays.count);
for (let round = 0; round < Number(rounds); ++round) {
  const began = process.hrtime.bigint();
  scene.closestHit(rays, hits);
  console.log(Number(process.hrtime.bigint() - began) * 1e-9);
}
