// SPDX-License-Identifier: Apache-2.0
// A camera that circles a target, and its perspective projection.

const fieldOfView = Math.PI / 5;
const mostElevation = Math.PI / 2 - 0.01;

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const unit = a => { const length = Math.hypot(...a) || 1; return a.map(x => x / length); };
const along = (a, b, t) => a.map((x, i) => x + b[i] * t);

export class Camera {
  constructor(up) {
    this.up = unit(up);
    this.east = unit(cross(this.up, Math.abs(this.up[0]) < 0.8 ? [1, 0, 0] : [0, 0, 1]));
    this.north = cross(this.up, this.east);
    this.azimuth = 0.7;
    this.elevation = 0.45;
    this.target = [0, 0, 0];
    this.distance = 1;
  }

  /** Stands back until the box fills the view. */
  frame(box) {
    this.target = [0, 1, 2].map(i => (box[i] + box[i + 3]) / 2);
    const radius = Math.hypot(box[3] - box[0], box[4] - box[1], box[5] - box[2]) / 2;
    this.distance = Math.max(radius, 1e-30) / Math.sin(fieldOfView / 2);
  }

  turn(dx, dy) {
    this.azimuth += dx;
    this.elevation = Math.min(Math.max(this.elevation + dy, -mostElevation), mostElevation);
  }

  zoom(factor) {
    this.distance *= factor;
  }

  /** Moves the target by parts of the view's height. */
  move(dx, dy) {
    const height = 2 * this.distance * Math.tan(fieldOfView / 2);
    const {right, up} = this.axes();
    this.target = along(along(this.target, right, -dx * height), up, dy * height);
  }

  axes() {
    const flat = Math.cos(this.elevation);
    const level = along(this.east.map(x => x * Math.sin(this.azimuth)), this.north, Math.cos(this.azimuth));
    const back = unit(along(level.map(x => x * flat), this.up, Math.sin(this.elevation)));
    const right = unit(cross(this.up, back));
    return {back, right, up: cross(back, right)};
  }

  /** A function from a point to [x, y, depth] in pixels and in world units; it is visible where
   *  depth > near. */
  projection(width, height) {
    const {back, right, up} = this.axes();
    const eye = along(this.target, back, this.distance);
    const scale = Math.min(width, height) / (2 * Math.tan(fieldOfView / 2));
    const near = this.distance * 1e-3;
    const project = (x, y, z) => {
      const offset = [x - eye[0], y - eye[1], z - eye[2]];
      const depth = -dot(offset, back);
      const size = scale / Math.max(depth, near);
      return [width / 2 + dot(offset, right) * size, height / 2 - dot(offset, up) * size, depth];
    };
    return {project, near, eye, back};
  }
}
