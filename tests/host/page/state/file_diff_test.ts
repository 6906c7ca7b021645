import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { chosenNumbers, groupByFile, jointsText, keyOf } from '../../../../host/page/source/state/file_diff.js';
import type { FileDiffEntry } from '../../../../host/page/source/wire/messages.js';

function entry(changes: Partial<FileDiffEntry>): FileDiffEntry {
  return { file: 'a.xml', line: 7, old: 'old', new: 'new', slot: 1, name: 'amplitude', joints: [0], ...changes };
}

describe('the differences from the file', () => {
  it('are grouped by file, in their order', () => {
    const entries = [entry({}), entry({ file: 'b.xml' }), entry({ name: 'frequency' })];
    assert.deepEqual(groupByFile(entries), [
      { file: 'a.xml', numbers: [0, 2] },
      { file: 'b.xml', numbers: [1] },
    ]);
    assert.deepEqual(groupByFile([]), []);
  });

  it('are all written but those that were left out, also after a value has changed once more', () => {
    const leftOut = new Set([keyOf(entry({ joints: [2] }))]);
    const diff = { diff: 'x', is_shipped: false, entries: [entry({}), entry({ joints: [2], new: 'newer', line: 9 }), entry({ slot: 2 })] };
    assert.deepEqual(chosenNumbers(diff, leftOut), [0, 2]);
    assert.deepEqual(chosenNumbers(diff, new Set()), [0, 1, 2]);
  });

  it('name their joints', () => {
    const names = ['J2', 'J1'];
    assert.equal(jointsText(entry({ joints: [0, 1] }), names, [0, 1]), 'all joints');
    assert.equal(jointsText(entry({ joints: [1] }), names, [0, 1]), 'J1');
    assert.equal(jointsText(entry({ joints: [1] }), names, [1]), 'all joints');
  });
});
