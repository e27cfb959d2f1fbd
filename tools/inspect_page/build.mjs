// SPDX-License-Identifier: Apache-2.0
// Bundles the page into one file and writes it as the C++ source that the command is linked with.
//
//   node build.mjs MODULES OUTPUT.cpp [OUTPUT.html]
//
// MODULES is the folder of the installed packages; OUTPUT.html receives the page with its markers,
// to look at.
import {readFileSync, readdirSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {dirname, join} from 'node:path';
import {fileURLToPath, pathToFileURL} from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const dataMarker = '<!--data-->';
// Compilers promise string literals of 64 KiB; longer ones are made of parts.
const literalLength = 8192;

/** Name, version and licence text of every package that went into the bundle. */
function notices(modules, inputs) {
  const names = new Set();
  for (const path of Object.keys(inputs)) {
    const match = path.replaceAll('\\', '/').match(/.*node_modules\/((?:@[^/]+\/)?[^/]+)\//);
    if (match) names.add(match[1]);
  }
  return [...names].sort().map(name => {
    const folder = join(modules, name);
    const {version} = JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8'));
    const licence = readdirSync(folder).find(file => /^licen[cs]e/i.test(file));
    return `${name} ${version}\n\n${readFileSync(join(folder, licence), 'utf8').trim()}`;
  }).join('\n\n----\n\n').replaceAll('-->', '-- >');
}

async function bundle(modules) {
  const require = createRequire(pathToFileURL(join(modules, 'any.js')));
  const esbuild = require(join(modules, 'esbuild'));
  const result = await esbuild.build({
    entryPoints: [join(here, 'src/main.js')],
    nodePaths: [modules],
    bundle: true,
    minify: true,
    format: 'iife',
    target: ['es2022'],
    charset: 'ascii',
    legalComments: 'none',
    metafile: true,
    write: false,
  });
  const style = await esbuild.transform(readFileSync(join(here, 'style.css'), 'utf8'),
                                        {loader: 'css', minify: true, charset: 'ascii'});
  return {
    script: result.outputFiles[0].text.trim(),
    style: style.code.trim(),
    notices: notices(modules, result.metafile.inputs),
  };
}

/** The page with everything in it but the data. */
function fill(parts) {
  return readFileSync(join(here, 'index.html'), 'utf8')
    .replace('<!--notices-->', () => `<!--\nThis page contains:\n\n${parts.notices}\n-->`)
    .replace('/*style*/', () => parts.style)
    .replace('/*script*/', () => parts.script);
}

/** The definition of a std::string_view of these bytes. */
function definition(name, text) {
  const bytes = Buffer.from(text, 'utf8');
  const literals = [];
  for (let at = 0; at < bytes.length; at += literalLength) {
    literals.push(`R"page(${bytes.subarray(at, at + literalLength).toString('latin1')})page"`);
  }
  return `const std::string_view ${name}{\n${literals.join('\n')},\n${bytes.length}};\n`;
}

const [modules, source, html] = process.argv.slice(2);
const page = fill(await bundle(modules));
const at = page.indexOf(dataMarker);
writeFileSync(source, Buffer.from(
  '#include "kiwami/inspect_page.h"\n\nnamespace kiwami::tools {\n\n' +
  definition('kInspectPageHead', page.slice(0, at)) + '\n' +
  definition('kInspectPageTail', page.slice(at + dataMarker.length)) +
  '\n}  // namespace kiwami::tools\n', 'latin1'));
if (html) writeFileSync(html, page);
