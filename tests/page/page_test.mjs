// SPDX-License-Identifier: Apache-2.0
// The page of `kiwami inspect --html` in a real, headless Chromium.
//
//   node page_test.mjs KIWAMI MODULES CHROMIUM
//
// KIWAMI is the command, MODULES the folder of the installed npm packages.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync, statSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import {join, resolve} from 'node:path';
import {after, before, describe, test} from 'node:test';
import {pathToFileURL} from 'node:url';

const [kiwami, modules, executablePath] = process.argv.slice(2);
const {chromium} = createRequire(resolve(modules, 'any.js'))('playwright-core');

const pipelines = ['binned_sah', 'ploc+rotation', 'lbvh,surface_area,unmerged'];
const Kind = {INNER: 0, LEAF: 1, FOLDED: 2, GROUP: 3};

let folder, browser;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'kiwami-page-'));
  browser = await chromium.launch({executablePath});
});

after(async () => {
  await browser?.close();
  rmSync(folder, {recursive: true, force: true});
});

/** Runs the command; returns the paths of the page and of its data. */
function inspect(name, scene, ...options) {
  const html = join(folder, `${name}.html`), json = join(folder, `${name}.json`);
  execFileSync(kiwami, ['inspect', scene, '--html', html, '--json', json, ...options]);
  return {html, data: JSON.parse(readFileSync(json, 'utf8'))};
}

/** Opens a page of 1,200 by 800 whose complaints and requests are kept. */
async function open(html, options = {}) {
  const page = await browser.newPage({viewport: {width: 1200, height: 800}, reducedMotion: 'reduce', ...options});
  const seen = {complaints: [], requests: []};
  page.on('console', message => {
    if (['error', 'warning'].includes(message.type())) seen.complaints.push(message.text());
  });
  page.on('pageerror', error => seen.complaints.push(error.stack));
  page.on('request', request => seen.requests.push(request.url()));
  await page.goto(pathToFileURL(html).href);
  await page.waitForFunction(() => document.getElementById('node-name').textContent !== '');
  await settle(page);
  return {page, seen};
}

/** Until what was asked to be drawn in the next frame is drawn. */
async function settle(page) {
  await page.evaluate(() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done))));
}

function children(nodes, row) {
  return nodes.parent.flatMap((parent, child) => (parent === row ? [child] : []));
}

/** What the arc of a row is as large as. */
function arcCost(nodes, row) {
  return nodes.subtree_cost[row];
}

/** Children in the order of the chart: by cost, what is joined last. */
function arcsBelow(nodes, row) {
  const isGroup = child => Number(nodes.kind[child] === Kind.GROUP);
  return children(nodes, row).sort(
    (a, b) => isGroup(a) - isGroup(b) || arcCost(nodes, b) - arcCost(nodes, a) || a - b);
}

/** A point of the first ring's arc number `i`, by default its middle and in the first chart, in pixels of
 *  the visible page. */
async function pointOfArc(page, nodes, focus, i, part = 0.5, chart = 0) {
  const arcs = arcsBelow(nodes, focus);
  const start = arcs.slice(0, i).reduce((sum, row) => sum + arcCost(nodes, row), 0);
  const turn = (start + arcCost(nodes, arcs[i]) * part) / arcCost(nodes, focus) * 2 * Math.PI;
  const box = await page.locator('.chart canvas').nth(chart).boundingBox();
  // The disc in the middle ends at 0.2 of the radius; nine rings at most lie between it and the rim.
  const distance = (Math.min(box.width, box.height) / 2 - 4) * (0.2 + 0.8 / 9 / 2);
  return {x: box.x + box.width / 2 + Math.sin(turn) * distance,
          y: box.y + box.height / 2 - Math.cos(turn) * distance};
}

async function clickArc(page, nodes, focus, i) {
  const {x, y} = await pointOfArc(page, nodes, focus, i);
  await page.mouse.click(x, y);
  await settle(page);
}

/** How many pixels of a canvas have each colour, most frequent first. */
function coloursOf(page, selector) {
  return page.locator(selector).first().evaluate(canvas => {
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d', {willReadFrequently: true});
    copy.drawImage(canvas, 0, 0);
    const {data} = copy.getImageData(0, 0, canvas.width, canvas.height);
    const counts = new Map();
    for (let i = 0; i < data.length; i += 4) {
      if (data[i + 3] < 255) continue;
      const key = `${data[i]},${data[i + 1]},${data[i + 2]}`;
      counts.set(key, (counts.get(key) ?? 0) + 1);
    }
    return [...counts].sort((a, b) => b[1] - a[1]);
  });
}

function picture(page, selector) {
  return page.locator(selector).first().evaluate(canvas => canvas.toDataURL());
}

const text = (page, id) => page.locator(`#${id}`).innerText();

/** A number as the page writes it, read back. */
function close(shown, expected) {
  const number = Number(shown.replaceAll(',', '').split(/[ \n]/)[0]);
  assert.ok(Math.abs(number - expected) <= Math.abs(expected) * 2e-3 + 1e-12, `${shown} is not ${expected}`);
}

describe('a page of three pipelines', () => {
  let html, data, page, seen;

  before(async () => {
    ({html, data} = inspect('three', 'soup:7200:1', '--nodes', '900', '--ray-count', '2000',
                            ...pipelines.flatMap(pipeline => ['--pipeline', pipeline])));
    ({page, seen} = await open(html));
  });

  test('loads without a complaint and asks for nothing else', async () => {
    assert.deepEqual(seen.complaints, []);
    assert.deepEqual(seen.requests, [pathToFileURL(html).href]);
    assert.equal(await page.title(), 'soup:7200:1 \u2013 Kiwami inspect');
    assert.match(await text(page, 'scene-facts'), /^7,200 triangles, 3 pipelines/);
  });

  test('cannot ask for anything else', async () => {
    const blocked = await page.evaluate(() => fetch('data:text/plain,x').then(() => false, () => true));
    assert.ok(blocked, 'the page\u2019s own policy lets it make requests');
    seen.complaints.length = 0;
  });

  test('shows all trees side by side, with arcs of many colours', async () => {
    assert.equal(await page.locator('.chart').count(), 3);
    for (let i = 0; i < 3; ++i) {
      const colours = await coloursOf(page, `.chart:nth-child(${i + 1}) canvas`);
      assert.ok(colours.filter(([, count]) => count > 20).length > 20, `chart ${i}: ${colours.length} colours`);
    }
    for (const pipeline of data.pipelines) {
      assert.ok(await page.locator('figcaption', {hasText: pipeline.name}).count() > 0, pipeline.name);
    }
  });

  test('shows the root first', async () => {
    const {nodes} = data.pipelines[0];
    assert.equal(await text(page, 'node-name'), 'Root');
    close(await text(page, 'fact-area'), nodes.area[0]);
    close(await text(page, 'fact-subtree-cost'), data.pipelines[0].sah_cost);
    close(await text(page, 'fact-primitives'), 7200);
    close(await text(page, 'fact-subtree-nodes'), data.pipelines[0].tree_node_count);
    assert.equal(await page.locator('#children button').count(), children(nodes, 0).length);
  });

  test('a click chooses the node under it and zooms in', async () => {
    await page.locator('#layouts button', {hasText: 'One'}).click();
    await settle(page);
    assert.equal(await page.locator('.chart').count(), 1);
    const {nodes} = data.pipelines[0];
    const unzoomed = await picture(page, '.chart canvas');
    await clickArc(page, nodes, 0, 1);
    const row = arcsBelow(nodes, 0)[1];
    assert.equal(nodes.kind[row], Kind.INNER);
    assert.equal(await text(page, 'node-name'), `Node ${nodes.index[row]}`);
    const box = (await text(page, 'fact-box-min')).split(', ').concat((await text(page, 'fact-box-max')).split(', '));
    box.forEach((shown, i) => close(shown, nodes.box[6 * row + i]));
    close(await text(page, 'fact-area'), nodes.area[row]);
    close(await text(page, 'fact-cost'), nodes.cost[row]);
    close(await text(page, 'fact-subtree-cost'), nodes.subtree_cost[row]);
    close(await text(page, 'fact-depth'), 1);
    close(await text(page, 'fact-primitives'), nodes.primitives[row]);
    close(await text(page, 'fact-overlap'), nodes.overlap[row]);
    close(await text(page, 'fact-visits'), nodes.visits[row] * 100);
    assert.notEqual(await picture(page, '.chart canvas'), unzoomed);
    // What was zoomed to fills the turn now: a click finds its children.
    await clickArc(page, nodes, row, 0);
    const below = arcsBelow(nodes, row)[0];
    assert.match(await text(page, 'node-name'), new RegExp(` ${nodes.index[below]}$`));
    assert.equal(await page.locator('#path button').count(), 2);
  });

  test('Escape and the middle go one up', async () => {
    const {nodes} = data.pipelines[0];
    const row = arcsBelow(nodes, 0)[1];
    await page.keyboard.press('Escape');
    assert.equal(await text(page, 'node-name'), `Node ${nodes.index[row]}`);
    const box = await page.locator('.chart canvas').first().boundingBox();
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
    assert.equal(await text(page, 'node-name'), 'Root');
  });

  test('the buttons of the list choose, too', async () => {
    await page.locator('#children button').nth(2).click();
    const {nodes} = data.pipelines[0];
    assert.match(await text(page, 'node-name'), new RegExp(` ${nodes.index[arcsBelow(nodes, 0)[2]]}$`));
    await page.locator('#path button', {hasText: 'Root'}).click();
    assert.equal(await text(page, 'node-name'), 'Root');
  });

  test('joined siblings say how many they are', async () => {
    const {nodes} = data.pipelines[0];
    const group = nodes.kind.findIndex((kind, row) =>
      kind === Kind.GROUP && nodes.parent[nodes.parent[row]] !== undefined);
    assert.ok(group > 0, 'no group in the data');
    const path = [];
    for (let row = nodes.parent[group]; row > 0; row = nodes.parent[row]) path.unshift(row);
    for (const row of path) await page.locator(`#children button[data-row="${row}"]`).click();
    await page.locator(`#children button[data-row="${group}"]`).click();
    assert.equal(await text(page, 'node-name'), `${nodes.members[group]} more nodes`);
    close(await text(page, 'fact-primitives'), nodes.primitives[group]);
    await page.locator('#path button', {hasText: 'Root'}).click();
  });

  test('the modes change the colours and the legend', async () => {
    const pictures = new Set();
    const legends = [/^Share of the whole tree/, /end-point overlap/, /^Share of the rays/];
    const buttons = page.locator('#modes button');
    const count = await buttons.count();
    assert.deepEqual(await buttons.allInnerTexts(), ['SAH share', 'Overlap', 'Visits']);
    for (let i = 0; i < count; ++i) {
      await buttons.nth(i).click();
      assert.equal(await buttons.nth(i).getAttribute('aria-pressed'), 'true');
      pictures.add(await picture(page, '.chart canvas'));
      assert.match(await text(page, 'legend'), legends[i]);
    }
    assert.equal(pictures.size, count);
    await buttons.first().click();
  });

  test('the pipelines can be switched', async () => {
    for (const [i, pipeline] of data.pipelines.entries()) {
      await page.locator('#pipelines button').nth(i).click();
      assert.match(await page.locator('figcaption').innerText(), new RegExp(pipeline.name.replace('+', '\\+')));
      close(await text(page, 'fact-subtree-cost'), pipeline.sah_cost);
      close(await text(page, 'fact-subtree-nodes'), pipeline.tree_node_count);
    }
    await page.locator('#pipelines button').first().click();
  });

  test('the scene can be turned, and shows the chosen box', async () => {
    const whole = await picture(page, '#scene');
    await page.locator('#children button').first().click();
    await settle(page);
    const chosen = await picture(page, '#scene');
    assert.notEqual(chosen, whole);
    const box = await page.locator('#scene').boundingBox();
    await page.mouse.move(box.x + 100, box.y + 150);
    await page.mouse.down();
    await page.mouse.move(box.x + 180, box.y + 120, {steps: 4});
    await page.mouse.up();
    await settle(page);
    const turned = await picture(page, '#scene');
    assert.notEqual(turned, chosen);
    await page.locator('#frame').click();
    await settle(page);
    assert.notEqual(await picture(page, '#scene'), turned);
    await page.locator('#reset').click();
    await settle(page);
    assert.equal(await picture(page, '#scene'), chosen);
  });

  test('an arc has the colour of its node in the list', async () => {
    const {nodes} = data.pipelines[0];
    await page.locator('#path button', {hasText: 'Root'}).click();
    const arcs = arcsBelow(nodes, 0);
    for (const [mode, column] of ['cost', 'overlap', 'visits'].entries()) {
      await page.locator('#modes button').nth(mode).click();
      const i = arcs.findIndex(row => nodes[column][row] > 0);
      const {x, y} = await pointOfArc(page, nodes, 0, i, 0.2);
      const listed = await page.locator('#children i').nth(i).evaluate(
        swatch => getComputedStyle(swatch).backgroundColor.match(/\d+/g).map(Number));
      const drawn = await page.locator('.chart canvas').first().evaluate((canvas, at) => {
        const {left, top} = canvas.getBoundingClientRect();
        const copy = new OffscreenCanvas(1, 1).getContext('2d', {willReadFrequently: true});
        copy.drawImage(canvas, left - at.x, top - at.y);
        return [...copy.getImageData(0, 0, 1, 1).data.slice(0, 3)];
      }, {x: Math.round(x), y: Math.round(y)});
      assert.deepEqual(drawn, listed, `${column} of arc ${i}`);
    }
    await page.locator('#modes button').first().click();
  });

  test('a hint follows the pointer', async () => {
    const {nodes} = data.pipelines[0];
    const {x, y} = await pointOfArc(page, nodes, 0, 0);
    await page.mouse.move(x, y);
    assert.match(await text(page, 'tooltip'), new RegExp(` ${nodes.index[arcsBelow(nodes, 0)[0]]}\\n`));
    await page.mouse.move(5, 5);
    assert.ok(await page.locator('#tooltip').isHidden());
  });

  test('nothing of this made a complaint', () => assert.deepEqual(seen.complaints, []));

  test('is dark where dark is wished', async () => {
    const {page: dark, seen: seenDark} = await open(html, {colorScheme: 'dark'});
    const shine = where => where.evaluate(() => getComputedStyle(document.body).backgroundColor)
      .then(colour => colour.match(/\d+/g).map(Number).reduce((sum, x) => sum + x) / 3);
    assert.ok(await shine(dark) < 60);
    assert.ok(await shine(page) > 200);
    assert.deepEqual(seenDark.complaints, []);
    await dark.close();
  });
});

test('two trees of builders without a binary tree stand side by side, and each can be looked into', async () => {
  const {html, data} = inspect('wide', 'terrain:60', '--ray-count', '500', '--pipeline', 'wide_linear+reorder_sato',
                               '--pipeline', 'trial+parallel_reinsertion');
  assert.deepEqual(data.pipelines.map(pipeline => pipeline.name.split(',')[0]),
                   ['wide_linear + reorder_sato', 'trial + parallel_reinsertion']);
  const {page, seen} = await open(html);
  const [left, right] = [await page.locator('.chart').nth(0).boundingBox(), await page.locator('.chart').nth(1).boundingBox()];
  assert.ok(left.x + left.width <= right.x + 1 && Math.abs(left.y - right.y) < 2, 'one is not beside the other');
  for (const [i, {nodes, name, sah_cost}] of data.pipelines.entries()) {
    const chart = page.locator('.chart').nth(i);
    assert.ok((await chart.locator('figcaption').innerText()).startsWith(name), name);
    const colours = await coloursOf(page, `.chart:nth-child(${i + 1}) canvas`);
    assert.ok(colours.filter(([, count]) => count > 20).length > 20, `${name}: ${colours.length} colours`);
    // A click in a chart chooses a node of its own tree.
    const {x, y} = await pointOfArc(page, nodes, 0, 0, 0.5, i);
    await page.mouse.click(x, y);
    await settle(page);
    const row = arcsBelow(nodes, 0)[0];
    assert.match(await text(page, 'node-name'), new RegExp(` ${nodes.index[row]}$`));
    close(await text(page, 'fact-subtree-cost'), nodes.subtree_cost[row]);
    await page.keyboard.press('Escape');
    close(await text(page, 'fact-subtree-cost'), sah_cost);
  }
  assert.deepEqual(seen.complaints, []);
  await page.close();
});

test('each arc is as wide as its cost, also what stands for many nodes', async () => {
  const {html, data} = inspect('few', 'terrain:60', '--nodes', '8', '--pipeline', 'lbvh');
  const {page, seen} = await open(html);
  const {nodes} = data.pipelines[0];
  const arcs = arcsBelow(nodes, 0);
  assert.equal(nodes.kind[arcs.at(-1)], Kind.GROUP);
  for (const [i, row] of arcs.entries()) {
    const name = nodes.kind[row] === Kind.GROUP ? `^${nodes.members[row]} more nodes\n` : `^Node ${nodes.index[row]}\n`;
    for (const part of [0.03, 0.97]) {
      const {x, y} = await pointOfArc(page, nodes, 0, i, part);
      await page.mouse.move(x, y);
      assert.match(await text(page, 'tooltip'), new RegExp(name), `arc ${i} at ${part}`);
    }
  }
  assert.deepEqual(seen.complaints, []);
  await page.close();
});

test('a tree of hundreds of thousands of nodes is a small page that opens at once', async () => {
  const {html, data} = inspect('large', 'terrain:500', '--pipeline', 'lbvh,surface_area,unmerged',
                               '--param', 'max_leaf_size=1', '--rays', 'none', '--no-overlap');
  assert.ok(data.pipelines[0].tree_node_count > 500000, String(data.pipelines[0].tree_node_count));
  assert.ok(data.pipelines[0].nodes.parent.length <= 10000);
  assert.ok(statSync(html).size < 3e6, `${statSync(html).size} bytes`);
  const started = Date.now();
  const {page, seen} = await open(html);
  assert.ok(Date.now() - started < 8000, `${Date.now() - started} ms`);
  assert.deepEqual(seen.complaints, []);
  close(await text(page, 'fact-subtree-nodes'), data.pipelines[0].tree_node_count);
  // Without rays and overlap, and for one pipeline, there is nothing to switch.
  assert.deepEqual(await page.locator('#modes button').allInnerTexts(), ['SAH share']);
  assert.ok(await page.locator('#pipelines').isHidden());
  await page.close();
});

test('a single triangle, and nothing at all', async () => {
  const one = join(folder, '<b>one.obj');
  writeFileSync(one, 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n');
  for (const [name, file, title] of [['one', one, 'Root'], ['none', emptyScene(), 'The tree is empty']]) {
    const {html} = inspect(name, file);
    const {page, seen} = await open(html);
    assert.equal(await text(page, 'node-name'), title);
    if (name === 'one') assert.equal(await text(page, 'scene-name'), '<b>one.obj');
    const box = await page.locator('.chart canvas').boundingBox();
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
    await page.keyboard.press('Escape');
    assert.deepEqual(seen.complaints, []);
    await page.close();
  }
});

/** A scene whose only triangle cannot be hit. */
function emptyScene() {
  const path = join(folder, 'nothing.tri');
  const bytes = Buffer.alloc(12 + 36 + 12);
  bytes.write('TRI1');
  bytes.writeUInt32LE(3, 4);
  bytes.writeUInt32LE(1, 8);
  for (let i = 0; i < 9; ++i) bytes.writeFloatLE(NaN, 12 + 4 * i);
  [0, 1, 2].forEach((vertex, i) => bytes.writeUInt32LE(vertex, 48 + 4 * i));
  writeFileSync(path, bytes);
  return path;
}
