import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { describe, it } from 'node:test';

const source = 'host/page/source';

// Files below a folder of the page that import a path with this text.
function filesThatImport(text: string, folder = ''): string[] {
  const files = readdirSync(`${source}/${folder}`, { recursive: true, encoding: 'utf8' }).filter((file) => /\.tsx?$/.test(file));
  assert.ok(files.length > 0);
  const imports = new RegExp(`(from|import\\()\\s*'[^']*${text}`);
  return files.filter((file) => imports.test(readFileSync(`${source}/${folder}/${file}`, 'utf8')));
}

describe('the files of the page', () => {
  it('take the stores that they read: only the start of the page imports the root', () => {
    assert.deepEqual(filesThatImport('/page_app\\.js'), ['app.tsx']);
  });

  it('are layers: panels import no page of recordings', () => {
    assert.deepEqual(filesThatImport('/recordings/', 'panels'), []);
  });

  it('name no element twice: hidden pages stay in the document, and the first element of a name counts', () => {
    const pages = ['panels/live_page.tsx', 'recordings/recordings_page.tsx', 'make/make_page.tsx', 'modules/modules_page.tsx'];
    const panels = pages.flatMap((page) => [...readFileSync(`${source}/${page}`, 'utf8').matchAll(/from '[^']*?(\w+)\.js'/g)].map(([, name]) => name as string));
    const shared = new Set(panels.filter((name, place) => panels.indexOf(name) !== place));
    assert.ok(shared.has('strip_panel') && shared.has('scene_panel'));
    const files = readdirSync(`${source}/panels`, { recursive: true, encoding: 'utf8' }).filter((file) => shared.has(file.replace(/^.*\/|\.tsx?$/g, '')));
    assert.deepEqual(files.filter((file) => / id=["'{]/.test(readFileSync(`${source}/panels/${file}`, 'utf8'))), []);
  });
});
