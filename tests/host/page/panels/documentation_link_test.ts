import assert from 'node:assert/strict';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { describe, it } from 'node:test';

const source = 'host/page/source';

// As the site makes them of headings (docs/mkdocs.yml): the words in lower case, with strokes between them.
function anchors(page: string): string[] {
  return [...page.matchAll(/^#+ (.*)$/gm)].map(([, heading]) => (heading as string).toLowerCase().replace(/[^\w\s-]/g, '').trim().replace(/\s/g, '-'));
}

describe('links of the page to the documentation', () => {
  const links = readdirSync(source, { recursive: true, encoding: 'utf8' })
    .filter((file) => file.endsWith('.tsx'))
    .flatMap((file) => [...readFileSync(`${source}/${file}`, 'utf8').matchAll(/<DocumentationLink\b[^>]*\bto="([^"]*)"/g)].map(([, to]) => ({ file, to: to as string })));

  it('lead to pages and headings that are there', () => {
    assert.ok(links.length >= 4);
    for (const { file, to } of links.filter((link) => link.to !== 'index.html')) {
      const [page, anchor] = to.split('#') as [string, string | undefined];
      const text = `docs/${page.replace(/\.html$/, '.md')}`;
      assert.ok(existsSync(text), `${file}: ${to}`);
      if (anchor !== undefined) assert.ok(anchors(readFileSync(text, 'utf8')).includes(anchor), `${file}: ${to}`);
    }
  });
});
