// SPDX-License-Identifier: Apache-2.0
// One pipeline's tree, from the columns that the command wrote.
import {hierarchy, partition} from 'd3-hierarchy';
import {count, counted} from './format.js';

export const Kind = Object.freeze({INNER: 0, LEAF: 1, FOLDED: 2, GROUP: 3});

export class Tree {
  constructor(pipeline) {
    this.pipeline = pipeline;
    this.columns = pipeline.nodes;
    this.size = this.columns.parent.length;
    this.root = this.size > 0 ? this.#layOut() : null;
    this.byRow = [];
    this.root?.each(node => { this.byRow[node.data] = node; });
  }

  /** Angles are x0 to x1 of a whole of 1; an inner node's own cost stays as a gap at its end. */
  #layOut() {
    const children = Array.from({length: this.size}, () => []);
    this.columns.parent.forEach((parent, row) => { if (parent >= 0) children[parent].push(row); });
    const root = hierarchy(0, row => children[row])
      .sum(row => (this.standsForMore(row) ? this.columns.subtree_cost : this.columns.cost)[row])
      .sort((a, b) => this.#isGroup(a) - this.#isGroup(b) || b.value - a.value || a.data - b.data);
    return partition()(root);
  }

  #isGroup(node) {
    return Number(this.kind(node.data) === Kind.GROUP);
  }

  kind(row) {
    return this.columns.kind[row];
  }

  /** Whether there are nodes below, or beside, that have no arc of their own. */
  standsForMore(row) {
    return this.kind(row) >= Kind.FOLDED;
  }

  get totalCost() {
    return this.columns.subtree_cost[0];
  }

  /** The value of a column for one node; of a group the mean of its members. */
  mean(column, row) {
    return this.columns[column][row] / this.columns.members[row];
  }

  box(row) {
    return this.columns.box.slice(6 * row, 6 * row + 6);
  }

  name(row) {
    if (this.kind(row) === Kind.GROUP) return `${counted(this.columns.members[row], 'more node')}`;
    if (row === 0) return 'Root';
    return `${this.kind(row) === Kind.LEAF ? 'Leaf' : 'Node'} ${count(this.columns.index[row])}`;
  }

  kindName(row) {
    switch (this.kind(row)) {
      case Kind.LEAF: return 'leaf';
      case Kind.INNER: return 'inner node';
      case Kind.FOLDED: return 'inner node, drawn without what is below';
      default: return 'siblings too small to draw one by one';
    }
  }
}
