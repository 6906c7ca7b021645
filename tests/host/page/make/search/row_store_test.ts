import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { RowStore } from '../../../../../host/page/source/make/search/row_store.js';
import { rowsFrom } from '../../support/search_program.js';

describe('the evaluations of a search', () => {
  it('are kept by their numbers, a hundred thousand of them too', () => {
    const store = new RowStore(1, 1);
    for (let from = 0; from < 100_000; from += 1000) store.append(rowsFrom(from, Array.from({ length: 1000 }, (_, i) => (from + i) / 7)));
    assert.equal(store.count, 100_000);
    assert.equal(store.scoreOf(99_999, 0), 99_999 / 7);
    assert.equal(store.valueOf(54_321, 0), 54_321 % 40);
    assert.ok(Number.isNaN(store.scoreOf(100_000, 0)), 'there is no such evaluation');
  });

  it('have a score for each objective and a value for each dimension', () => {
    const store = new RowStore(2, 3);
    store.append({ from: 0, made: 2, scores: [[1, 2], [3, 4]], values: [[5, 6, 7], [8, 9, 10.25]], flags: [0, 2] });
    assert.deepEqual([store.scoreOf(1, 0), store.scoreOf(1, 1)], [3, 4]);
    assert.deepEqual([0, 1, 2].map((dimension) => store.valueOf(1, dimension)), [8, 9, 10.25]);
    assert.deepEqual([store.has(0, 2), store.has(1, 2)], [false, true]);
  });

  it('have no score if they failed, or if none was sent', () => {
    const store = new RowStore(1, 1);
    store.append({ from: 0, made: 3, scores: [[0], [null as unknown as number], [1.5]], values: [[1], [2], [3]], flags: [1, 0, 0] });
    assert.deepEqual([0, 1, 2].map((row) => store.hasScore(row, 0)), [false, false, true]);
  });

  it('must follow one another', () => {
    const store = new RowStore(1, 1);
    store.append(rowsFrom(0, [1, 2]));
    assert.throws(() => store.append(rowsFrom(3, [4])), /found those from 3 on, expected those from 2 on/);
    assert.throws(() => store.append({ ...rowsFrom(2, [3]), flags: [] }), /found 1 values and 0 flags, expected 1/);
    assert.equal(store.count, 2);
  });

  it('are left out where a page would need hundreds of megabytes for them', () => {
    const store = new RowStore(1, 1000);
    assert.ok(store.capacity * 1000 * 4 <= 128 * 2 ** 20);
    assert.ok(store.capacity > 30_000);
    assert.ok(new RowStore(1, 5).capacity > 6_000_000);
  });
});
