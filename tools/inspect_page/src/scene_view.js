// SPDX-License-Identifier: Apache-2.0
// The second pane: the chosen node's box and its children's in the scene, drawn from back to front.
import {Camera} from './camera.js';
import {fitCanvas, themeOf} from './canvas.js';

const mostChildBoxes = 64;
const turnPerPixel = 0.008;

const edges = [[0, 1], [0, 2], [0, 4], [1, 3], [1, 5], [2, 3], [2, 6], [3, 7], [4, 5], [4, 6], [5, 7], [6, 7]];

export class SceneView {
  constructor(canvas, scene) {
    this.canvas = canvas;
    this.scene = scene;
    this.camera = new Camera(scene.up);
    this.box = null;
    this.children = [];
    this.isWhole = true;
    this.pending = false;
    this.#prepare();
    this.reset();
    this.#listen();
  }

  /** Normals and middles of the triangles, once. */
  #prepare() {
    const {vertices, triangles} = this.scene.shape;
    this.faces = [];
    for (let i = 0; i + 2 < triangles.length; i += 3) {
      const [a, b, c] = [0, 1, 2].map(k => {
        const at = 3 * triangles[i + k];
        return [vertices[at], vertices[at + 1], vertices[at + 2]];
      });
      const u = b.map((x, k) => x - a[k]), v = c.map((x, k) => x - a[k]);
      const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
      const length = Math.hypot(...normal) || 1;
      this.faces.push({
        corners: [triangles[i], triangles[i + 1], triangles[i + 2]],
        normal: normal.map(x => x / length),
        middle: a.map((x, k) => (x + b[k] + c[k]) / 3),
      });
    }
  }

  reset() {
    this.camera = new Camera(this.scene.up);
    this.camera.frame(this.scene.bounds);
    this.update();
  }

  frame() {
    if (this.box) this.camera.frame(this.box);
    this.update();
  }

  /** `box` and `children` are boxes of six numbers; `isWhole`: all of the scene is in the box. */
  show(box, children, isWhole) {
    this.box = box;
    this.isWhole = isWhole;
    this.children = children.slice(0, mostChildBoxes);
    this.update();
  }

  /** Draws once before the next frame, however often it is asked. */
  update() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      this.draw();
    });
  }

  #listen() {
    let last = null;
    this.canvas.addEventListener('pointerdown', event => {
      last = event;
      this.canvas.setPointerCapture(event.pointerId);
    });
    this.canvas.addEventListener('pointermove', event => {
      if (!last) return;
      const dx = event.clientX - last.clientX, dy = event.clientY - last.clientY;
      last = event;
      if (event.shiftKey || event.buttons === 4) {
        const {height} = this.canvas.getBoundingClientRect();
        this.camera.move(dx / height, dy / height);
      } else {
        this.camera.turn(-dx * turnPerPixel, dy * turnPerPixel);
      }
      this.update();
    });
    for (const name of ['pointerup', 'pointercancel']) {
      this.canvas.addEventListener(name, () => { last = null; });
    }
    this.canvas.addEventListener('wheel', event => {
      event.preventDefault();
      this.camera.zoom(Math.exp(event.deltaY * 0.001));
      this.update();
    }, {passive: false});
    this.canvas.addEventListener('keydown', event => this.#key(event));
  }

  #key(event) {
    const turns = {ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1]};
    const zooms = {'+': 0.85, '=': 0.85, '-': 1 / 0.85};
    if (turns[event.key]) {
      this.camera.turn(...turns[event.key]);
    } else if (zooms[event.key]) {
      this.camera.zoom(zooms[event.key]);
    } else {
      return;
    }
    event.preventDefault();
    this.update();
  }

  draw() {
    const context = fitCanvas(this.canvas);
    if (!context) return;
    const {width, height} = this.canvas.getBoundingClientRect();
    const theme = themeOf(this.canvas);
    const pen = {context, theme, ...this.camera.projection(width, height)};
    this.#drawFaces(pen);
    this.#drawBox(this.scene.bounds, theme.sceneBox, 1, pen);
    for (const child of this.children) this.#drawBox(child, theme.childBox, 1.1, pen);
    if (this.box) this.#drawBox(this.box, theme.box, 2, pen);
  }

  #drawFaces({context, theme, project, near, eye, back}) {
    const {vertices} = this.scene.shape;
    const points = [];
    for (let i = 0; i + 2 < vertices.length; i += 3) points.push(project(vertices[i], vertices[i + 1], vertices[i + 2]));
    const visible = [];
    for (const face of this.faces) {
      const corners = face.corners.map(corner => points[corner]);
      if (corners.some(corner => corner[2] <= near)) continue;
      visible.push({face, corners, depth: corners[0][2] + corners[1][2] + corners[2][2]});
    }
    visible.sort((a, b) => b.depth - a.depth);
    const chosen = this.isWhole ? null : this.box;
    const cut = depthOf(middleOf(this.box ?? this.scene.bounds), {eye, back});
    for (const {face, corners, depth} of visible) {
      const inside = chosen !== null && contains(chosen, face.middle);
      const ray = face.middle.map((x, i) => x - eye[i]);
      const facing = Math.abs(face.normal[0] * ray[0] + face.normal[1] * ray[1] + face.normal[2] * ray[2]) /
                     (Math.hypot(...ray) || 1);
      const light = 0.45 + 0.55 * facing;
      const colour = (inside ? theme.solid : theme.surface).map(x => Math.round(x * light));
      // What stands before the chosen box must not hide it.
      const opacity = inside ? 0.85 : depth < 3 * cut ? 0.14 : 0.5;
      context.fillStyle = `rgb(${colour.join(' ')} / ${opacity})`;
      context.beginPath();
      corners.forEach(([x, y], i) => (i === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
      context.fill();
    }
  }

  #drawBox(box, colour, lineWidth, {context, project, near, eye, back}) {
    const corner = i => [box[i & 1 ? 3 : 0], box[i & 2 ? 4 : 1], box[i & 4 ? 5 : 2]];
    const depth = point => depthOf(point, {eye, back});
    context.beginPath();
    for (const [from, to] of edges) {
      const line = clip(corner(from), corner(to), depth, near);
      if (!line) continue;
      const [a, b] = line.map(point => project(...point));
      context.moveTo(a[0], a[1]);
      context.lineTo(b[0], b[1]);
    }
    context.strokeStyle = colour;
    context.lineWidth = lineWidth;
    context.stroke();
  }
}

function middleOf(box) {
  return [0, 1, 2].map(i => (box[i] + box[i + 3]) / 2);
}

/** How far before the eye a point lies. */
function depthOf(point, {eye, back}) {
  return point.reduce((sum, x, i) => sum - (x - eye[i]) * back[i], 0);
}

function contains(box, point) {
  return point.every((x, i) => x >= box[i] && x <= box[i + 3]);
}

/** The part of an edge that is before the eye, or null. */
function clip(a, b, depth, near) {
  const first = depth(a) - near, second = depth(b) - near;
  if (first <= 0 && second <= 0) return null;
  if (first > 0 && second > 0) return [a, b];
  const t = first / (first - second);
  const cut = a.map((x, i) => x + (b[i] - x) * (t + (first > 0 ? -1e-6 : 1e-6)));
  return first > 0 ? [a, cut] : [cut, b];
}
