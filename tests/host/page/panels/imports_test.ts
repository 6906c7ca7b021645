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
});
