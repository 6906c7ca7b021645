import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { lineDiff } from '../../../../host/page/source/make/line_diff.js';

// The old text with the changes made: another way from one text to the other than that of the code.
function patched(before: string, after: string): string {
  const changes = lineDiff(before, after);
  const old = before.split('\n');
  const result: string[] = [];
  let at = 0;
  const kept = (line: number) => {
    while (result.length + 1 < line) result.push(old[at++] as string);
  };
  for (const { line, kind, text } of changes) {
    kept(line);
    if (kind === 'added') {
      result.push(text);
    } else {
      assert.equal(old[at], text);
      at += 1;
    }
  }
  return [...result, ...old.slice(at)].join('\n');
}

describe('the difference of two texts', () => {
  it('is nothing for the same text', () => {
    assert.deepEqual(lineDiff('a\nb', 'a\nb'), []);
  });

  it('names the lines that change', () => {
    assert.deepEqual(lineDiff('a\nb\nc', 'a\nB\nc'), [
      { line: 2, kind: 'removed', text: 'b' },
      { line: 2, kind: 'added', text: 'B' },
    ]);
    assert.deepEqual(lineDiff('a\nc', 'a\nb\nc'), [{ line: 2, kind: 'added', text: 'b' }]);
    assert.deepEqual(lineDiff('a\nb\nc', 'a\nc'), [{ line: 2, kind: 'removed', text: 'b' }]);
  });

  it('leads from one text to the other, for random texts', () => {
    let seed = 11;
    const random = (bound: number) => (seed = (seed * 48271) % 2147483647) % bound;
    for (let i = 0; i < 200; i += 1) {
      const text = () => Array.from({ length: random(12) }, () => 'abc'[random(3)]).join('\n');
      const before = text();
      const after = text();
      assert.equal(patched(before, after), after, `seed 11, text ${i}`);
    }
  });

  it('ends soon for long texts that have nothing in common', () => {
    const long = (letter: string) => Array.from({ length: 5000 }, (_, i) => `${letter}${i}`).join('\n');
    assert.equal(lineDiff(long('a'), long('b')).length, 10000);
  });
});
