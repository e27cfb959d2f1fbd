// SPDX-License-Identifier: Apache-2.0
// What the colour of an arc says, on one scale for all pipelines so that they can be compared.
import {scaleSequentialLog} from 'd3-scale';
import {interpolateInferno, interpolatePlasma, interpolateViridis} from 'd3-scale-chromatic';
import {measure, percent} from './format.js';

// More decades than this make neighbours look alike.
const mostDecades = 4;

const modes = [
  {
    id: 'cost', label: 'SAH share', title: 'Share of the whole tree\u2019s cost (SAH)',
    write: percent, ramp: interpolateViridis, value: (tree, row) => tree.mean('cost', row) / tree.totalCost,
  },
  {
    id: 'overlap', label: 'Overlap', title: 'A node\u2019s part of the end-point overlap (EPO)',
    write: measure, ramp: interpolateInferno, value: (tree, row) => tree.mean('overlap', row),
  },
  {
    id: 'visits', label: 'Visits', title: 'Share of the rays that visit a node',
    write: percent, ramp: interpolatePlasma, value: (tree, row) => tree.mean('visits', row),
  },
];

export class ColourMode {
  constructor(mode, trees) {
    Object.assign(this, mode);
    let least = Infinity, most = 0;
    for (const tree of trees) {
      for (let row = 0; row < tree.size; ++row) {
        const value = this.value(tree, row);
        if (value > 0) least = Math.min(least, value);
        most = Math.max(most, value);
      }
    }
    if (most === 0) least = most = 1;
    least = Math.max(least, most * 10 ** -mostDecades);
    if (least === most) least = most / 10;
    this.domain = [least, most];
    // The darkest and the palest tenth would vanish in a dark or a light page.
    this.scale = scaleSequentialLog(this.domain, at => this.ramp(0.1 + 0.85 * at)).clamp(true);
  }

  /** null where there is nothing: no overlap, no visit. */
  colour(tree, row) {
    const value = this.value(tree, row);
    return value > 0 ? this.scale(value) : null;
  }

  position(value) {
    return Math.log(value / this.domain[0]) / Math.log(this.domain[1] / this.domain[0]);
  }

  /** Powers of ten within the domain, or its ends where there are none. */
  ticks() {
    const ticks = [];
    for (let power = Math.ceil(Math.log10(this.domain[0]) - 1e-9); 10 ** power <= this.domain[1]; ++power) {
      ticks.push(10 ** power);
    }
    return (ticks.length > 1 ? ticks : this.domain).map(value => ({at: this.position(value), text: this.write(value)}));
  }

  gradient() {
    const stops = Array.from({length: 11}, (_, i) => this.ramp(0.1 + 0.085 * i));
    return `linear-gradient(90deg, ${stops.join(', ')})`;
  }
}

/** The modes for which every pipeline has figures. */
export function colourModes(trees) {
  const available = modes.filter(mode => trees.every(tree => tree.columns[mode.id]));
  return available.map(mode => new ColourMode(mode, trees));
}
