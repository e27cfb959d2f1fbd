// SPDX-License-Identifier: Apache-2.0
// What both panes need of a canvas.

/** Gives the canvas one pixel for each of the screen's and returns a cleared context, or null. */
export function fitCanvas(canvas) {
  const {width, height} = canvas.getBoundingClientRect();
  if (width < 1 || height < 1) return null;
  const ratio = window.devicePixelRatio || 1;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  const context = canvas.getContext('2d');
  context.scale(ratio, ratio);
  return context;
}

/** The colours of the style sheet. */
export function themeOf(element) {
  const style = getComputedStyle(element);
  const read = name => style.getPropertyValue(`--${name}`).trim();
  return {
    ink: read('ink'), quiet: read('quiet'), panel: read('panel'), accent: read('accent'),
    edge: read('edge'), gap: read('gap'), box: read('box'), childBox: read('child-box'),
    sceneBox: read('scene-box'), surface: read('surface').split(' ').map(Number),
    solid: read('solid').split(' ').map(Number),
  };
}
