// SPDX-License-Identifier: Apache-2.0
// The sunburst chart of one tree on a canvas. The focus is the disc in the middle, its descendants
// are the rings around it.
import {interpolateNumber} from 'd3-interpolate';
import {arc} from 'd3-shape';
import {count, percent} from './format.js';
import {Kind} from './tree.js';
import {fitCanvas, themeOf} from './canvas.js';

const mostRings = 9;
const fewestRings = 3;
const leastCoverage = 0.06;  // of the turn: rings that hold less wait for a zoom
const middleShare = 0.2;  // of the radius
const leastMiddleForText = 22;  // pixels
const leastPixels = 0.5;  // an arc that is narrower is drawn together with its neighbours
const strokePixels = 3;
const zoomMilliseconds = 420;
const wholeTurn = 2 * Math.PI;

/** How many rings around a node are worth their room. */
function ringsBelow(node) {
  const widths = new Array(mostRings + 1).fill(0);
  const pending = [node];
  while (pending.length > 0) {
    const next = pending.pop();
    widths[next.depth - node.depth] += next.x1 - next.x0;
    if (next.depth - node.depth < mostRings && next.children) pending.push(...next.children);
  }
  const least = leastCoverage * (node.x1 - node.x0);
  return Math.max(widths.findLastIndex(width => width >= least), fewestRings);
}

export class Sunburst {
  /** `onPick(node)` is called with a node of the tree; `onHover(node or null, event)`. */
  constructor(canvas, tree, {onPick, onHover}) {
    this.canvas = canvas;
    this.tree = tree;
    this.focus = tree.root;
    this.selected = tree.root;
    this.hovered = null;
    this.view = this.#viewOf(this.focus);
    this.mode = null;
    canvas.addEventListener('click', event => this.#click(event, onPick));
    canvas.addEventListener('mousemove', event => this.#hover(this.nodeAt(event), event, onHover));
    canvas.addEventListener('mouseleave', event => this.#hover(null, event, onHover));
  }

  setMode(mode) {
    this.mode = mode;
    this.draw();
  }

  /** Chooses a node and turns the chart to it: a leaf is shown among its siblings. */
  select(node, animated = true) {
    this.selected = node;
    const focus = node.children || !node.parent ? node : node.parent;
    const changed = focus !== this.focus;
    this.focus = focus;
    if (changed && animated && !matchMedia('(prefers-reduced-motion: reduce)').matches) {
      this.#zoom();
    } else {
      this.view = this.#viewOf(focus);
      this.draw();
    }
  }

  #viewOf(node) {
    if (!node) return {x0: 0, x1: 1, depth: 0, rings: fewestRings};
    return {x0: node.x0, x1: node.x1, depth: node.depth, rings: ringsBelow(node)};
  }

  #zoom() {
    const from = this.view, to = this.#viewOf(this.focus), target = this.focus;
    const started = performance.now();
    const mixed = Object.keys(to).map(key => [key, interpolateNumber(from[key], to[key])]);
    const step = now => {
      if (this.focus !== target) return;  // another zoom has begun
      const part = Math.min(Math.max((now - started) / zoomMilliseconds, 0), 1);
      const eased = part * part * (3 - 2 * part);
      this.view = Object.fromEntries(mixed.map(([key, mix]) => [key, mix(eased)]));
      this.draw();
      if (part < 1) requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  #geometry() {
    const {width, height} = this.canvas.getBoundingClientRect();
    const radius = Math.max(Math.min(width, height) / 2 - 4, 1);
    return {width, height, radius, middle: radius * middleShare,
            ring: (radius * (1 - middleShare)) / this.view.rings};
  }

  /** The pixels from the centre to where `depth` begins. */
  #radiusAt(depth, geometry) {
    const rings = depth - this.view.depth;
    if (rings <= 0) return 0;
    if (rings < 1) return geometry.middle * rings;
    return Math.min(geometry.middle + (rings - 1) * geometry.ring, geometry.radius);
  }

  #angleAt(x) {
    const part = (x - this.view.x0) / (this.view.x1 - this.view.x0);
    return Math.min(Math.max(part, 0), 1) * wholeTurn;
  }

  #shape(node, geometry) {
    return {
      startAngle: this.#angleAt(node.x0),
      endAngle: this.#angleAt(node.x1),
      innerRadius: this.#radiusAt(node.depth, geometry),
      outerRadius: this.#radiusAt(node.depth + 1, geometry),
    };
  }

  /** The node under the pointer, or null. */
  nodeAt(event) {
    if (!this.tree.root) return null;
    const rectangle = this.canvas.getBoundingClientRect();
    const geometry = this.#geometry();
    const x = event.clientX - rectangle.left - geometry.width / 2;
    const y = event.clientY - rectangle.top - geometry.height / 2;
    const distance = Math.hypot(x, y);
    if (distance > geometry.radius) return null;
    if (distance < geometry.middle) return this.focus;
    const ring = 1 + Math.floor((distance - geometry.middle) / geometry.ring);
    const part = ((Math.atan2(x, -y) + wholeTurn) % wholeTurn) / wholeTurn;
    const at = this.view.x0 + part * (this.view.x1 - this.view.x0);
    let node = this.focus;
    for (let i = 0; i < ring && node; ++i) {
      node = node.children?.find(child => child.x0 <= at && at < child.x1);
    }
    return node ?? null;
  }

  #click(event, onPick) {
    const node = this.nodeAt(event);
    if (!node) return;
    // A click on what is in the middle already goes one up.
    onPick(node === this.focus && node.parent ? node.parent : node);
  }

  #hover(node, event, onHover) {
    this.canvas.style.cursor = node ? 'pointer' : 'default';
    if (node !== this.hovered) {
      this.hovered = node;
      this.draw();
    }
    onHover(node, event);
  }

  draw() {
    const context = fitCanvas(this.canvas);
    if (!context || !this.tree.root || !this.mode) return;
    const theme = themeOf(this.canvas);
    const geometry = this.#geometry();
    context.translate(geometry.width / 2, geometry.height / 2);
    const outline = arc().context(context);
    this.#drawBelow(this.#upmost(), {context, theme, geometry, outline});
    this.#drawMark(this.hovered, {context, theme, geometry, outline}, theme.ink, 1.5);
    if (this.selected !== this.focus) {
      this.#drawMark(this.selected, {context, theme, geometry, outline}, theme.accent, 3);
    }
    this.#drawMiddle(context, theme, geometry);
  }

  /** The ancestor of the focus from which all that is in view can be reached while zooming. */
  #upmost() {
    let node = this.focus;
    while (node.parent && node.depth > this.view.depth) node = node.parent;
    while (node.parent && (node.x0 > this.view.x0 || node.x1 < this.view.x1)) node = node.parent;
    return node;
  }

  #drawBelow(top, pen) {
    const last = this.view.depth + this.view.rings + 1;
    const pending = [top];
    while (pending.length > 0) {
      const node = pending.pop();
      const shape = this.#shape(node, pen.geometry);
      if (node.children && node.depth + 1 >= this.view.depth) this.#drawGap(shape, node, pen);
      if (node.depth >= this.view.depth) this.#drawArc(node, shape, pen);
      if (node.children && node.depth + 1 < last) pending.push(...this.#drawNarrow(node, pen));
    }
  }

  /** Draws neighbours that are too narrow to be seen as one arc; returns the other children. */
  #drawNarrow(parent, pen) {
    const wide = [];
    let run = null;
    for (const child of parent.children) {
      const shape = this.#shape(child, pen.geometry);
      if (child.depth <= this.view.depth || widthOf(shape) >= leastPixels) {
        wide.push(child);
      } else if (run) {
        run.shape.endAngle = shape.endAngle;
      } else {
        run = {first: child, shape};
      }
    }
    if (run && widthOf(run.shape) >= leastPixels) this.#drawArc(run.first, run.shape, pen);
    return wide;
  }

  #drawArc(node, shape, {context, theme, outline}) {
    const width = widthOf(shape);
    if (shape.outerRadius - shape.innerRadius < 0.5) return;
    const row = node.data, kind = this.tree.kind(row);
    const colour = this.mode.colour(this.tree, row);
    context.beginPath();
    outline(shape);
    context.globalAlpha = kind === Kind.GROUP ? 0.4 : colour ? 1 : 0.45;
    context.fillStyle = colour ?? theme.quiet;
    context.fill();
    context.globalAlpha = 1;
    if (width > strokePixels) {
      context.strokeStyle = theme.edge;
      context.lineWidth = 0.8;
      context.stroke();
    }
    if (kind === Kind.FOLDED && width > 2 * strokePixels) this.#drawFoldedEdge(shape, context, theme);
    if (node !== this.focus && node.depth > this.view.depth) this.#drawShare(node, shape, context, colour);
  }

  /** What a node's children leave of its turn: its own cost. */
  #drawGap(shape, node, {context, theme, geometry, outline}) {
    const outerRadius = this.#radiusAt(node.depth + 2, geometry);
    if (outerRadius - shape.outerRadius < 0.5) return;
    context.beginPath();
    outline({...shape, innerRadius: shape.outerRadius, outerRadius});
    context.fillStyle = theme.gap;
    context.fill();
  }

  #drawFoldedEdge(shape, context, theme) {
    const quarter = wholeTurn / 4;
    context.beginPath();
    context.arc(0, 0, shape.outerRadius - 1.2, shape.startAngle - quarter, shape.endAngle - quarter);
    context.setLineDash([1.5, 2.5]);
    context.strokeStyle = theme.ink;
    context.lineWidth = 1.6;
    context.stroke();
    context.setLineDash([]);
  }

  /** The share of the subtree in the whole, where there is room for it. */
  #drawShare(node, shape, context, colour) {
    const middle = (shape.innerRadius + shape.outerRadius) / 2;
    const along = (shape.endAngle - shape.startAngle) * middle;
    const thick = shape.outerRadius - shape.innerRadius;
    if (along < 15 || thick < 44) return;
    const angle = (shape.startAngle + shape.endAngle) / 2;
    context.save();
    context.rotate(angle - wholeTurn / 4);
    context.translate(middle, 0);
    if (angle > wholeTurn / 2) context.rotate(wholeTurn / 2);
    context.fillStyle = isDark(colour) ? '#fff' : '#16171a';
    context.font = `11px ${getComputedStyle(this.canvas).fontFamily}`;
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    context.fillText(percent(node.value / this.tree.root.value), 0, 0);
    context.restore();
  }

  #drawMark(node, {context, geometry, outline}, colour, lineWidth) {
    if (!node || node.depth < this.view.depth) return;
    const shape = this.#shape(node, geometry);
    if (shape.endAngle <= shape.startAngle || shape.outerRadius <= shape.innerRadius) return;
    context.beginPath();
    outline(shape);
    context.strokeStyle = colour;
    context.lineWidth = lineWidth;
    context.stroke();
  }

  #drawMiddle(context, theme, geometry) {
    const row = this.focus.data;
    context.beginPath();
    context.arc(0, 0, geometry.middle - 1, 0, wholeTurn);
    context.fillStyle = theme.panel;
    context.fill();
    if (this.selected === this.focus) {
      context.strokeStyle = theme.accent;
      context.lineWidth = 2;
      context.stroke();
    }
    if (geometry.middle < leastMiddleForText) return;
    const family = getComputedStyle(this.canvas).fontFamily;
    const size = Math.max(Math.min(geometry.middle / 3.6, 15), 9);
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    const lines = [
      [this.tree.name(row), `600 ${size}px ${family}`, theme.ink],
      [percent(this.focus.value / this.tree.root.value), `${size}px ${family}`, theme.ink],
      [`${count(this.tree.columns.subtree_nodes[row])} nodes`, `${size * 0.8}px ${family}`, theme.quiet],
    ];
    if (geometry.middle < 38) lines.pop();
    lines.forEach(([text, font, colour], i) => {
      context.font = font;
      context.fillStyle = colour;
      context.fillText(text, 0, (i - (lines.length - 1) / 2) * size * 1.35, geometry.middle * 1.75);
    });
  }
}

/** The pixels along an arc's rim. */
function widthOf(shape) {
  return (shape.endAngle - shape.startAngle) * shape.outerRadius;
}

function isDark(colour) {
  if (!colour) return false;
  const [red, green, blue] = colour.startsWith('#')
    ? [1, 3, 5].map(at => parseInt(colour.slice(at, at + 2), 16))
    : colour.match(/[\d.]+/g).map(Number);
  return 0.299 * red + 0.587 * green + 0.114 * blue < 140;
}
