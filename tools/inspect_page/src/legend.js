// SPDX-License-Identifier: Apache-2.0

/** Explains the colours of a mode, and the arcs that are not coloured by it. */
export function showLegend(holder, mode) {
  const ramp = document.createElement('div');
  ramp.className = 'ramp';
  ramp.style.background = mode.gradient();
  const ticks = document.createElement('div');
  ticks.className = 'ticks';
  for (const {at, text} of mode.ticks()) {
    const tick = document.createElement('span');
    tick.style.left = `${at * 100}%`;
    tick.textContent = text;
    ticks.append(tick);
  }
  const scale = document.createElement('div');
  const title = document.createElement('div');
  title.className = 'scale-title';
  title.textContent = mode.title;
  scale.append(title, ramp, ticks);

  const keys = document.createElement('div');
  keys.className = 'keys';
  const entries = [
    ['gap', 'gap: the cost of the node itself'],
    ['group', 'pale: several small siblings in one arc'],
    ['folded', 'dotted: more below than is drawn'],
  ];
  if (mode.id !== 'cost') entries.push(['none', 'grey: none']);
  for (const [name, text] of entries) {
    const key = document.createElement('span');
    const swatch = document.createElement('i');
    swatch.className = name;
    key.append(swatch, text);
    keys.append(key);
  }
  holder.replaceChildren(scale, keys);
}
