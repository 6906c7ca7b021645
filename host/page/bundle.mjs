// Bundles the page, or its tests.
//   node bundle.mjs page FOLDER      index.html, app.js with its chunks, the workers, style.css; the same of a class: class.html
//                                    and so on; notices.txt: the licences of the packages in them; FOLDER_sizes.json
//   node bundle.mjs player FOLDER    player.html, into which proleg export --html writes a recording
//   node bundle.mjs tests FOLDER     each *_test.ts of tests/host/page as one program for `node --test`
//   node bundle.mjs figures FOLDER   the program of tools/page_figures
//   node bundle.mjs film FOLDER      the program of tools/film, and film.js, which draws in a browser
import { build } from 'esbuild';
import { createHash } from 'node:crypto';
import { cpSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { dirname, join, relative } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { noticesOf } from './notices.mjs';
import { unusedShaders } from './unused_shaders.mjs';

const room = dirname(fileURLToPath(import.meta.url));
const tests = join(room, '../../tests/host/page');

// Sizes in bytes of gzip. The first chunk is what the page needs for the top bar, STOP and the connection.
const largestFirstChunk = 40 * 1024;
const largestMake = 60 * 1024; // the page Make
const largestSearch = 30 * 1024; // the part Search of Make
const largestSweep = 12 * 1024; // the sweeps in it
const largestModules = 30 * 1024; // the page Modules
const largestEditor = 150 * 1024; // of sources, with CodeMirror
const largestClass = 40 * 1024; // the page of a class with all that it loads
const largestPage = 220 * 1024 + largestClass + largestMake + largestSearch + largestModules + largestEditor;

// Bytes of the player as it is in every exported recording.
const largestPlayer = 800 * 1024;

const common = { bundle: true, target: 'es2022', legalComments: 'none', logLevel: 'warning', absWorkingDir: room, plugins: [unusedShaders] };

async function bundlePage(folder) {
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
  const page = { ...common, minify: true, outdir: folder, jsx: 'automatic', jsxImportSource: 'preact' };
  const inChunks = { format: 'esm', splitting: true, chunkNames: 'chunk-[name]-[hash]', metafile: true };
  const result = await build({
    ...page,
    entryPoints: { app: 'source/app.tsx', style: 'source/style/style.css' },
    ...inChunks,
  });
  // By itself: chunks that both pages share would be smaller, and more of them, for each. Nothing is cached (docs/page-interface.md).
  const ofClass = await build({
    ...page,
    entryPoints: [
      { in: 'source/class.tsx', out: 'class' },
      { in: 'source/style/class.css', out: 'class' },
    ],
    ...inChunks,
  });
  // Workers are programs of their own: they share no chunk with the page. The warnings of three.js are for people who write
  // scenes; its errors stay.
  const workers = await build({
    ...page,
    pure: ['console.warn'],
    metafile: true,
    entryPoints: {
      connection_worker: 'source/wire/connection_worker.ts',
      scene_worker: 'source/scene/scene_worker.ts',
      tile_worker: 'source/class/tile_worker.ts',
    },
    format: 'iife',
  });
  writeFileSync(join(folder, 'notices.txt'), noticesOf([result, ofClass, workers].map(({ metafile }) => metafile)));
  for (const html of ['index.html', 'class.html']) cpSync(join(room, 'source', html), join(folder, html));
  // What the first paint, the connection and STOP need.
  const first = [...filesOf(result.metafile, 'app.js', false), 'index.html', 'style.css', 'connection_worker.js'];
  const all = [...filesOf(ofClass.metafile, 'class.js', true), 'class.html', 'class.css', 'connection_worker.js', 'tile_worker.js'];
  return checkSizes(folder, new Set(first), new Set(all));
}

// Names of a program and its chunks; `later`: also of those that it loads when it needs them.
function filesOf(metafile, program, later) {
  const pending = Object.keys(metafile.outputs).filter((file) => file.endsWith(`/${program}`));
  const found = new Set();
  while (pending.length > 0) {
    const file = pending.pop();
    if (found.has(file)) continue;
    found.add(file);
    for (const imported of metafile.outputs[file].imports) {
      if (imported.kind === 'import-statement' || (later && imported.kind === 'dynamic-import')) pending.push(imported.path);
    }
  }
  return [...found].map((file) => file.split('/').at(-1));
}

function checkSizes(folder, first, ofClass) {
  let raw = 0;
  let compressed = 0;
  let compressedFirst = 0;
  let compressedClass = 0;
  let compressedMake = 0;
  let compressedSearch = 0;
  let compressedSweep = 0;
  let compressedModules = 0;
  let compressedEditor = 0;
  for (const name of readdirSync(folder).sort()) {
    const bytes = readFileSync(join(folder, name));
    const size = gzipSync(bytes, { level: 9 }).length;
    raw += bytes.length;
    compressed += size;
    compressedFirst += first.has(name) ? size : 0;
    compressedClass += ofClass.has(name) ? size : 0;
    compressedMake += name.startsWith('chunk-make_page-') ? size : 0;
    compressedSearch += name.startsWith('chunk-search_part-') ? size : 0;
    compressedSweep += name.startsWith('chunk-sweep_part-') ? size : 0;
    compressedModules += name.startsWith('chunk-modules_page-') ? size : 0;
    compressedEditor += name.startsWith('chunk-code_mirror-') ? size : 0;
    print(name + (first.has(name) ? ' (first)' : ''), bytes.length, size);
  }
  print('first chunk', NaN, compressedFirst);
  print('the page of a class', NaN, compressedClass);
  print('all', raw, compressed);
  writeFileSync(`${folder}_sizes.json`, `${JSON.stringify({ first: compressedFirst, all: compressed })}\n`);
  let fits = true;
  for (const [what, size, largest] of [
    ['the first chunk', compressedFirst, largestFirstChunk],
    ['the page of a class', compressedClass, largestClass],
    ['the page Make', compressedMake, largestMake],
    ['the part Search', compressedSearch, largestSearch],
    ['the sweeps', compressedSweep, largestSweep],
    ['the page Modules', compressedModules, largestModules],
    ['the editor of sources', compressedEditor, largestEditor],
    ['the page', compressed, largestPage],
  ]) {
    if (size > largest) {
      console.error(`tools/page: found ${size} compressed bytes in ${what}, expected at most ${largest}`);
      fits = false;
    }
  }
  return fits;
}

function print(name, raw, compressed) {
  const kilobytes = (size) => (Number.isNaN(size) ? '' : `${(size / 1024).toFixed(1)} kB`).padStart(11);
  console.log(`${name.padEnd(36)}${kilobytes(raw)}${kilobytes(compressed)} compressed`);
}

async function bundleTests(folder) {
  const files = readdirSync(tests, { recursive: true, withFileTypes: true })
    .filter((entry) => entry.isFile() && entry.name.endsWith('_test.ts'))
    .map((entry) => relative(tests, join(entry.path, entry.name)));
  await bundlePrograms(files, folder);
  await bundleFilmPage(folder);
  return files.length > 0;
}

async function bundleFigures(folder) {
  await bundlePrograms(['figures/page_figures.ts'], folder);
  return true;
}

async function bundleFilm(folder) {
  await bundlePrograms(['film/film.ts'], folder);
  await bundleFilmPage(folder);
  return true;
}

async function bundleFilmPage(folder) {
  await build({ ...common, minify: true, pure: ['console.warn'], entryPoints: ['source/film/film.ts'], outdir: folder, format: 'iife' });
}

// Programs for Node.
async function bundlePrograms(files, folder) {
  rmSync(folder, { recursive: true, force: true });
  await build({
    ...common,
    entryPoints: files.map((file) => join(tests, file)),
    outbase: tests,
    outdir: folder,
    outExtension: { '.js': '.cjs' },
    platform: 'node',
    format: 'cjs',
    external: ['playwright-core', 'axe-core'],
    nodePaths: [join(room, 'node_modules')],
    sourcemap: 'inline',
  });
}

async function bundlePlayer(folder) {
  const metafiles = [];
  const entry = async (file, format) => {
    const options = { ...common, minify: true, jsx: 'automatic', jsxImportSource: 'preact', metafile: true, write: false };
    const result = await build({ ...options, entryPoints: [join(room, 'source', file)], ...(format ? { format } : {}) });
    metafiles.push(result.metafile);
    return result.outputFiles[0].text.trim();
  };
  const style = await entry('style/player.css');
  const worker = await entry('scene/scene_worker.ts', 'iife');
  const player = await entry('player/player.tsx', 'iife');
  const icon = /<link rel="icon"[^>]*>/.exec(readFileSync(join(room, 'source/index.html'), 'utf8'))[0];
  // Only these texts run, whatever a recording contains, and nothing is loaded.
  const sum = (text) => `'sha256-${createHash('sha256').update(text).digest('base64')}'`;
  const policy =
    `default-src 'none'; script-src ${sum(player)}; style-src ${sum(style)}; worker-src blob:; img-src data:; ` +
    `base-uri 'none'; form-action 'none'`;
  const parts = { policy, icon, style, 'scene worker': worker, player };
  for (const [name, text] of Object.entries(parts)) {
    // Else the browser would not read the element to its end, or beyond it.
    if (/<\/(script|style)|<!--/i.test(text)) {
      console.error(`tools/page: found the end of an element in the ${name}, expected a text without one`);
      return false;
    }
  }
  const notices = noticesOf(metafiles);
  if (notices.includes('-->')) {
    console.error('tools/page: found the end of a comment in the notices, expected a text without one');
    return false;
  }
  parts.notices = `<!--\n${notices}-->`;
  const template = readFileSync(join(room, 'source/player/player.html'), 'utf8');
  const page = template.replace(/<!-- (policy|icon|style|scene worker|player|notices) -->/g, (_, name) => parts[name]);
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
  writeFileSync(join(folder, 'player.html'), page);
  const size = Buffer.byteLength(page);
  print('player.html', size, gzipSync(page, { level: 9 }).length);
  if (size > largestPlayer) {
    console.error(`tools/page: found ${size} bytes in the player, expected at most ${largestPlayer}`);
    return false;
  }
  return true;
}

const [what, folder] = process.argv.slice(2);
const bundles = { page: bundlePage, player: bundlePlayer, tests: bundleTests, figures: bundleFigures, film: bundleFilm };
const succeeded = await bundles[what](folder);
process.exit(succeeded ? 0 : 1);
