import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { mostRanked, Ranking, sortedBy } from '../../../../../host/page/source/make/search/ranking.js';
import { RowStore } from '../../../../../host/page/source/make/search/row_store.js';
import { Random } from '../../support/random.js';
import { rowsFrom } from '../../support/search_program.js';

function ranked(scores: readonly number[], flags: readonly number[] = [], maximise = true) {
  const store = new RowStore(1, 1);
  store.append({ ...rowsFrom(0, scores), flags: scores.map((_, row) => flags[row] ?? 0) });
  const ranking = new Ranking(store, 0, maximise);
  ranking.update();
  return { store, ranking };
}

describe('the best candidates', () => {
  it('are those with the best scores, the earlier of two equal ones first', () => {
    assert.deepEqual(ranked([1, 3, 2, 3]).ranking.best, [1, 3, 2, 0]);
    assert.deepEqual(ranked([1, 3, 2, 3], [], false).ranking.best, [0, 2, 1, 3]);
  });

  it('come before those that were given up, and those before the failed ones', () => {
    const [failed, givenUp] = [1, 2];
    assert.deepEqual(ranked([5, 9, 1, 8], [failed, givenUp, 0, 0]).ranking.best, [3, 2, 1, 0]);
  });

  it('are each there once, although a search may evaluate them again', () => {
    const known = 4;
    assert.deepEqual(ranked([2, 2, 1], [0, known, 0]).ranking.best, [0, 2]);
  });

  it('are the same as after sorting all, while rows come in', () => {
    for (let seed = 1; seed <= 50; seed += 1) {
      const random = new Random(seed);
      const maximise = random.next() < 0.5;
      const store = new RowStore(1, 1);
      const ranking = new Ranking(store, 0, maximise);
      const scores: number[] = [];
      while (scores.length < 500) {
        const more = Array.from({ length: random.integer(0, 60) }, () => random.integer(-20, 200));
        store.append(rowsFrom(scores.length, more));
        scores.push(...more);
        ranking.update();
      }
      const order = scores.map((_, row) => row).sort((a, b) => (maximise ? scores[b]! - scores[a]! : scores[a]! - scores[b]!) || a - b);
      assert.deepEqual(ranking.best, order.slice(0, mostRanked), `seed ${seed}`);
    }
  });

  it('begin anew with another search in the folder, also if it has as many evaluations', () => {
    const { store, ranking } = ranked([5, 4]);
    store.clear();
    store.append(rowsFrom(0, [1, 2, 3]));
    ranking.update();
    assert.deepEqual(ranking.best, [2, 1, 0]);
  });
});

describe('the best so far', () => {
  it('has the evaluations that were better than all before', () => {
    assert.deepEqual(ranked([1, 1, 3, 2, 4]).ranking.records, [0, 2, 4]);
    assert.deepEqual(ranked([3, 4, 2, 2, 1], [], false).ranking.records, [0, 2, 4]);
  });

  it('has none that failed or was given up', () => {
    assert.deepEqual(ranked([9, 1, 8, 2], [1, 0, 2, 0]).ranking.records, [1, 3]);
  });
});

describe('the table of candidates', () => {
  const { store } = ranked([2, 5, NaN, 3]);
  const rows = [0, 1, 2, 3];

  it('is sorted by any column, either way', () => {
    assert.deepEqual(sortedBy(store, rows, { kind: 'number' }, true), [3, 2, 1, 0]);
    assert.deepEqual(sortedBy(store, rows, { kind: 'value', index: 0 }, false), [0, 1, 2, 3]);
    assert.deepEqual(sortedBy(store, [3, 1], { kind: 'value', index: 0 }, false), [1, 3]);
  });

  it('has what has no number in the column last, either way', () => {
    assert.deepEqual(sortedBy(store, rows, { kind: 'score', index: 0 }, true), [1, 3, 0, 2]);
    assert.deepEqual(sortedBy(store, rows, { kind: 'score', index: 0 }, false), [0, 3, 1, 2]);
  });
});
