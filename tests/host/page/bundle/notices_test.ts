// The licences of the packages in the page and the player ask that their notices go along with each copy.
import assert from 'node:assert/strict';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { dirname, join, normalize } from 'node:path';
import { describe, it } from 'node:test';

const room = 'host/page';
const lock = JSON.parse(readFileSync(`${room}/package-lock.json`, 'utf8')) as {
  packages: Record<string, { version: string; dev?: boolean; dependencies?: Record<string, string> }>;
};

function sourceOf(path: string): string | undefined {
  return [path, path.replace(/\.js$/, '.ts'), path.replace(/\.js$/, '.tsx')].find((file) => existsSync(file));
}

// The packages that these sources, and all that they import, name in imports of more than types.
function importedBy(entries: readonly string[]): Set<string> {
  const packages = new Set<string>();
  const files = entries.map((entry) => `${room}/source/${entry}`);
  const known = new Set<string>();
  while (files.length > 0) {
    const file = files.pop() as string;
    if (known.has(file)) continue;
    known.add(file);
    const text = readFileSync(file, 'utf8');
    if (file.endsWith('.tsx')) packages.add('preact'); // its elements
    for (const [, path = ''] of text.matchAll(/(?:^(?:import|export)\b(?! type)[^;'"()=]*\bfrom |^import |\bimport\(|@import )['"]([^'"]+)['"]/gm)) {
      const next = path.startsWith('.') ? sourceOf(normalize(join(dirname(file), path))) : undefined;
      if (next !== undefined) files.push(next);
      else if (!path.startsWith('.')) packages.add((/^(@[^/]+\/)?[^/]+/.exec(path) as RegExpExecArray)[0]);
    }
  }
  return packages;
}

// With the packages that these depend on.
function withDependencies(names: Iterable<string>): Set<string> {
  const found = new Set<string>(names);
  for (const name of found) Object.keys(lock.packages[`node_modules/${name}`]?.dependencies ?? {}).forEach((needed) => found.add(needed));
  return found;
}

function expectNotices(text: string, packages: ReadonlySet<string>): void {
  for (const name of packages) {
    const { version } = lock.packages[`node_modules/${name}`] ?? assert.fail(`${name}: found it not in the lock file`);
    const folder = `${room}/node_modules/${name}`;
    const file = readdirSync(folder).find((candidate) => /^licen[cs]e/i.test(candidate)) ?? assert.fail(`${name}: found no licence`);
    assert.ok(text.includes(`${name} ${version}`), `found no notice of ${name} ${version}`);
    assert.ok(text.includes(readFileSync(`${folder}/${file}`, 'utf8').trim()), `found no licence of ${name}`);
  }
}

describe('the notices of packages', () => {
  const copyright = readFileSync('tools/release.d/copyright.in', 'utf8');

  it('are with the page, for each package that it imports', () => {
    const packages = withDependencies(
      importedBy(['app.tsx', 'class.tsx', 'wire/connection_worker.ts', 'scene/scene_worker.ts', 'class/tile_worker.ts', 'style/style.css', 'style/class.css']),
    );
    for (const name of ['preact', 'three', 'uplot', 'uqr', '@codemirror/view', '@lezer/cpp']) assert.ok(packages.has(name), name);
    expectNotices(readFileSync('build/page/notices.txt', 'utf8'), packages);
    for (const page of ['index', 'class']) assert.match(readFileSync(`build/page/${page}.html`, 'utf8'), /<link rel="license" href="notices.txt" \/>/);
  });

  it('are in the player, which each exported recording has', () => {
    const packages = withDependencies(importedBy(['player/player.tsx', 'scene/scene_worker.ts', 'style/player.css']));
    for (const name of ['preact', 'three', '@preact/signals-core']) assert.ok(packages.has(name), name);
    expectNotices(readFileSync('build/player/player.html', 'utf8'), packages);
  });

  it('have their holders in the file `copyright` of the Debian package', () => {
    const families = Object.keys(lock.packages).flatMap((path) => {
      const name = path.replace('node_modules/', '');
      return path === '' || lock.packages[path]?.dev === true ? [] : [/^@(codemirror|lezer)\//.exec(name)?.[0].concat('*') ?? name];
    });
    for (const name of new Set(families)) assert.ok(copyright.includes(name), `found no ${name} in copyright.in`);
  });
});
