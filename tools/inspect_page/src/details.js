// SPDX-License-Identifier: Apache-2.0
// The chosen node in words and numbers, the way to it, and what is below it.
import {count, counted, measure, percent, point} from './format.js';
import {Kind} from './tree.js';

const mostChildren = 32;

function element(name, properties = {}, children = []) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

/** The rows of the table: [id, term, value, remark]. */
export function factsOf(tree, node) {
  const row = node.data, columns = tree.columns, box = tree.box(row);
  const isGroup = tree.kind(row) === Kind.GROUP;
  const facts = [
    ['kind', 'Kind', tree.kindName(row), ''],
    ['box-min', isGroup ? 'Box around all, from' : 'Box, from', point(...box.slice(0, 3)), ''],
    ['box-max', 'to', point(...box.slice(3)), ''],
    ['box-size', 'size', point(...[0, 1, 2].map(i => box[i + 3] - box[i])), ''],
    ['area', isGroup ? 'Surface areas, summed' : 'Surface area', measure(columns.area[row]), ''],
    ['cost', isGroup ? 'Own costs, summed' : 'Own cost (SAH)', measure(columns.cost[row]),
     percent(columns.cost[row] / tree.totalCost)],
    ['subtree-cost', 'Cost with all below', measure(columns.subtree_cost[row]),
     percent(columns.subtree_cost[row] / tree.totalCost)],
    ['depth', 'Depth', count(columns.depth[row]), ''],
    ['primitives', 'Primitives', count(columns.primitives[row]), ''],
    ['subtree-nodes', isGroup ? 'Nodes, all below included' : 'Nodes, this one included',
     count(columns.subtree_nodes[row]), ''],
  ];
  if (columns.overlap) {
    const total = tree.pipeline.epo;
    facts.push(['overlap', 'Own overlap (EPO)', measure(columns.overlap[row]),
                percent(total > 0 ? columns.overlap[row] / total : 0)]);
  }
  if (columns.visits) facts.push(['visits', 'Visits', percent(columns.visits[row]), 'of the rays']);
  return facts;
}

export class Details {
  constructor(document, onPick) {
    this.onPick = onPick;
    this.path = document.getElementById('path');
    this.name = document.getElementById('node-name');
    this.facts = document.getElementById('facts');
    this.title = document.getElementById('children-title');
    this.children = document.getElementById('children');
  }

  show(tree, node, mode) {
    this.name.textContent = tree.name(node.data);
    this.facts.replaceChildren(...factsOf(tree, node).flatMap(([id, term, value, remark]) => [
      element('dt', {textContent: term}),
      element('dd', {id: `fact-${id}`}, [value, ...(remark ? [' ', element('small', {textContent: remark})] : [])]),
    ]));
    this.#showPath(tree, node);
    this.#showChildren(tree, node, mode);
  }

  #button(tree, node, contents) {
    const button = element('button', {type: 'button'}, contents);
    button.dataset.row = node.data;
    button.addEventListener('click', () => this.onPick(node));
    return button;
  }

  #showPath(tree, node) {
    const parts = [];
    for (const ancestor of node.ancestors().reverse()) {
      if (ancestor === node) {
        parts.push(tree.name(node.data));
      } else {
        parts.push(this.#button(tree, ancestor, [tree.name(ancestor.data)]), ' \u203a ');
      }
    }
    this.path.replaceChildren(...parts);
  }

  #showChildren(tree, node, mode) {
    const children = node.children ?? [];
    const rest = children.length - mostChildren;
    this.title.textContent = children.length === 0 ? ''
      : `${counted(children.length, 'arc')} below` + (rest > 0 ? `, the first ${mostChildren}:` : '');
    this.children.replaceChildren(...children.slice(0, mostChildren).map(child => {
      const swatch = element('i');
      const colour = mode.colour(tree, child.data);
      if (colour) swatch.style.background = colour;
      return this.#button(tree, child, [
        swatch,
        element('span', {textContent: tree.name(child.data)}),
        element('em', {textContent: counted(tree.columns.primitives[child.data], 'primitive')}),
        element('span', {textContent: percent(child.value / tree.root.value)}),
      ]);
    }));
  }
}
