import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { textParts } from '../../../../../host/page/source/make/algorithm/text_parts.js';

describe('the parts of a text', () => {
  it('are the text, in messages that are short enough', () => {
    const text = `${'"\\\n\u0001'.repeat(9000)}end`;
    const parts = textParts(text);
    assert.equal(parts.join(''), text);
    assert.ok(parts.length > 1);
    for (const part of parts) {
      assert.ok(new TextEncoder().encode(JSON.stringify(part)).length < 62 * 1024);
    }
  });

  it('do not split a character', () => {
    assert.deepEqual(textParts('ab🤖cd', 3), ['ab', '🤖c', 'd']);
    assert.deepEqual(textParts('🤖', 2), ['🤖']);
  });

  it('are one, also of an empty text', () => {
    assert.deepEqual(textParts(''), ['']);
    assert.deepEqual(textParts('ab'), ['ab']);
  });
});
