// SPDX-License-Identifier: Apache-2.0
// The page of `kiwami inspect --html`: holds what is chosen, and tells the panes.
import {colourModes} from './colours.js';
import {Details} from './details.js';
import {count, counted, measure, percent} from './format.js';
import {showLegend} from './legend.js';
import {SceneView} from './scene_view.js';
import {Sunburst} from './sunburst.js';
import {Tree} from './tree.js';

const data = JSON.parse(document.getElementById('data').textContent);
const trees = data.pipelines.map(pipeline => new Tree(pipeline));
const modes = colourModes(trees);
const sceneView = new SceneView(document.getElementById('scene'), data.scene);
const details = new Details(document, node => pick(state.pipeline, node));
const tooltip = document.getElementById('tooltip');
const chartsHolder = document.getElementById('charts');

const state = {pipeline: 0, several: trees.length > 1, mode: modes[0], framed: false};
const charts = trees.map(makeChart);

function makeChart(tree, i) {
  const figure = document.createElement('figure');
  figure.className = 'chart';
  const holder = document.createElement('div');
  holder.className = 'holder';
  const canvas = document.createElement('canvas');
  canvas.setAttribute('role', 'img');
  canvas.setAttribute('aria-label', `Sunburst chart of ${tree.pipeline.name}`);
  holder.append(canvas);
  const caption = document.createElement('figcaption');
  const name = document.createElement('b');
  name.textContent = tree.pipeline.name;
  caption.append(name, factsOfPipeline(tree.pipeline));
  figure.append(holder, caption);
  figure.addEventListener('click', () => choosePipeline(i));
  return {
    figure,
    sunburst: new Sunburst(canvas, tree, {
      onPick: node => pick(i, node),
      onHover: (node, event) => showTooltip(tree, node, event),
    }),
  };
}

function factsOfPipeline(pipeline) {
  const facts = [`SAH ${measure(pipeline.sah_cost)}`];
  if (pipeline.epo !== undefined) facts.push(`EPO ${measure(pipeline.epo)}`);
  if (pipeline.visits_per_ray !== undefined) facts.push(`${measure(pipeline.visits_per_ray)} visits/ray`);
  facts.push(counted(pipeline.tree_node_count, 'node'), `depth ${count(pipeline.depth)}`);
  // A line may end between two facts, not within one.
  return facts.map(fact => fact.replaceAll(' ', '\u00a0')).join(' \u00b7 ');
}

function pick(pipeline, node) {
  state.pipeline = pipeline;
  charts[pipeline].sunburst.select(node);
  update();
}

function choosePipeline(i) {
  if (state.pipeline === i) return;
  state.pipeline = i;
  update();
}

function showTooltip(tree, node, event) {
  tooltip.hidden = !node;
  if (!node) return;
  const row = node.data;
  const name = document.createElement('b');
  name.textContent = tree.name(row);
  tooltip.replaceChildren(
    name,
    `${percent(node.value / tree.root.value)} of the cost, ` +
    `${counted(tree.columns.primitives[row], 'primitive')}, ` +
    `${state.mode.label} ${state.mode.write(state.mode.value(tree, row))}`);
  const {width, height} = tooltip.getBoundingClientRect();
  tooltip.style.left = `${Math.min(event.clientX + 14, innerWidth - width - 8)}px`;
  tooltip.style.top = `${Math.min(event.clientY + 14, innerHeight - height - 8)}px`;
}

/** Fills a row of buttons of which one is pressed. */
function makeChoice(id, labels, choose) {
  const holder = document.getElementById(id);
  labels.forEach((label, i) => {
    const button = document.createElement('button');
    button.type = 'button';
    button.textContent = label;
    button.addEventListener('click', () => choose(i));
    holder.append(button);
  });
  return chosen => [...holder.querySelectorAll('button')].forEach(
    (button, i) => button.setAttribute('aria-pressed', String(i === chosen)));
}

const markPipeline = makeChoice('pipelines', trees.map(tree => tree.pipeline.name), choosePipeline);
const markLayout = makeChoice('layouts', ['One', 'Side by side'], i => {
  state.several = i === 1;
  arrange();
  update();
});
const markMode = makeChoice('modes', modes.map(mode => mode.label), i => {
  state.mode = modes[i];
  update();
});
if (trees.length < 2) {
  document.getElementById('pipelines').hidden = true;
  document.getElementById('layouts').hidden = true;
}

/** Puts the charts on the page: one of them, or all in a grid. */
function arrange() {
  chartsHolder.classList.toggle('several', state.several);
  const columns = state.several ? Math.ceil(Math.sqrt(trees.length)) : 1;
  chartsHolder.style.gridTemplateColumns = `repeat(${columns}, minmax(0, 1fr))`;
}

function update() {
  const tree = trees[state.pipeline], {sunburst} = charts[state.pipeline];
  const shown = state.several ? charts : [charts[state.pipeline]];
  if (chartsHolder.children.length !== shown.length || chartsHolder.firstChild !== shown[0].figure) {
    chartsHolder.replaceChildren(...shown.map(chart => chart.figure));
  }
  charts.forEach((chart, i) => chart.figure.classList.toggle('chosen', i === state.pipeline));
  for (const chart of shown) chart.sunburst.setMode(state.mode);
  markPipeline(state.pipeline);
  markLayout(Number(state.several));
  markMode(modes.indexOf(state.mode));
  showLegend(document.getElementById('legend'), state.mode);
  showNode(tree, sunburst.selected);
}

function showNode(tree, node) {
  if (!node) {
    document.getElementById('node-name').textContent = 'The tree is empty';
    return;
  }
  details.show(tree, node, state.mode);
  sceneView.show(tree.box(node.data), (node.children ?? []).map(child => tree.box(child.data)),
                 node === tree.root);
  if (state.framed) sceneView.frame();
}

function redraw() {
  for (const chart of charts) chart.sunburst.draw();
  sceneView.update();
}

document.title = `${data.scene.name} \u2013 Kiwami inspect`;
document.getElementById('scene-name').textContent = data.scene.name;
document.getElementById('scene-facts').textContent =
  `${counted(data.scene.triangle_count, 'triangle')}, ` +
  `${counted(trees.length, 'pipeline')}, Kiwami ${data.version}`;
document.getElementById('frame').addEventListener('click', event => {
  state.framed = !state.framed;
  event.currentTarget.setAttribute('aria-pressed', String(state.framed));
  if (state.framed) sceneView.frame();
});
document.getElementById('reset').addEventListener('click', () => {
  state.framed = false;
  document.getElementById('frame').setAttribute('aria-pressed', 'false');
  sceneView.reset();
});
document.addEventListener('keydown', event => {
  const {selected} = charts[state.pipeline].sunburst;
  if (event.key === 'Escape' && selected?.parent) pick(state.pipeline, selected.parent);
});
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redraw);
new ResizeObserver(redraw).observe(chartsHolder);
arrange();
update();
