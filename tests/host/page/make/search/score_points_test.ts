import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { learningCurve, valueChart } from '../../../../../host/page/source/make/search/chart_content.js';
import { Ranking } from '../../../../../host/page/source/make/search/ranking.js';
import { RowStore } from '../../../../../host/page/source/make/search/row_store.js';
import { axisTicks, drawnRows, mostPoints, nearestPoint, scoreRange, thinningStep } from '../../../../../host/page/source/make/search/score_points.js';
import { Random } from '../../support/random.js';
import { rowsFrom } from '../../support/search_program.js';

function searchWith(scores: readonly number[], maximise = true) {
  const store = new RowStore(1, 1);
  store.append(rowsFrom(0, scores));
  const ranking = new Ranking(store, 0, maximise);
  ranking.update();
  return { store, ranking };
}

describe('the points of a chart', () => {
  it('are all evaluations, as long as they are some thousands', () => {
    const { store, ranking } = searchWith([3, 1, 2]);
    assert.deepEqual(drawnRows(ranking, store, null), [0, 1, 2]);
    assert.equal(thinningStep(mostPoints), 1);
  });

  it('of a hundred thousand are some thousands, the same ones while others come', () => {
    const random = new Random(1);
    const { store, ranking } = searchWith(Array.from({ length: 100_000 }, () => random.next()));
    const rows = drawnRows(ranking, store, null);
    assert.ok(rows.length <= mostPoints + 100, `${rows.length} points`);
    const step = thinningStep(100_000);
    assert.ok(rows.includes(5 * step));
    store.append(rowsFrom(100_000, [0.5]));
    ranking.update();
    assert.deepEqual(drawnRows(ranking, store, null).slice(0, 100), rows.slice(0, 100));
  });

  it('always have the best, the records and the chosen one', () => {
    const random = new Random(2);
    const { store, ranking } = searchWith(Array.from({ length: 50_000 }, () => random.next()));
    const rows = new Set(drawnRows(ranking, store, 33_333));
    for (const row of [...ranking.best, ...ranking.records, 33_333]) assert.ok(rows.has(row), `evaluation ${row}`);
    assert.equal(new Set(drawnRows(ranking, store, 33_333)).size, drawnRows(ranking, store, 33_333).length);
  });

  it('are found by a click near them, the nearest first', () => {
    const [x, y] = [Float32Array.of(10, 20, 100), Float32Array.of(10, 10, 50)];
    assert.equal(nearestPoint(x, y, { x: 17, y: 11 }, 14), 1);
    assert.equal(nearestPoint(x, y, { x: 60, y: 30 }, 14), null);
  });
});

describe('the axis of scores', () => {
  it('has all of them, with some room', () => {
    assert.deepEqual(scoreRange([1, 2, 3], true), [0.9, 3.1]);
    assert.deepEqual(scoreRange([2], true), [1.5, 2.5]);
    assert.deepEqual(scoreRange([], true), [0, 1]);
  });

  it('leaves out a few that are so bad that all others would be one line', () => {
    const costs = [...Array.from({ length: 99 }, (_, i) => 10 + i / 10), 1e6];
    const [low, high] = scoreRange(costs, false);
    assert.ok(low < 10 && high > 19 && high < 40, `${low} to ${high}`);
    const distances = costs.map((cost) => -cost);
    const [lowest, highest] = scoreRange(distances, true);
    assert.deepEqual([lowest, highest], [-high, -low]);
  });

  it('always has the best, however far it is from the others', () => {
    const scores = [...Array.from({ length: 99 }, (_, i) => i / 100), 50];
    assert.ok(scoreRange(scores, true)[1] > 50);
  });

  it('has round numbers', () => {
    assert.deepEqual(axisTicks(0.13, 2.2, 4), [1, 2]);
    assert.deepEqual(axisTicks(0, 40, 4), [0, 10, 20, 30, 40]);
    assert.deepEqual(axisTicks(0.9, 3.1, 5), [1, 1.5, 2, 2.5, 3]);
    assert.deepEqual(axisTicks(-0.3, 0.3, 3), [-0.2, 0, 0.2]);
    assert.deepEqual(axisTicks(1, 1, 3), []);
  });
});

describe('the learning curve', () => {
  it('has each evaluation, the best so far as steps to the end, and the level of the own values', () => {
    const { store, ranking } = searchWith([1, 3, 2, 4, 2]);
    const curve = learningCurve({ store, ranking, chosen: 2, hasBaseline: true });
    assert.deepEqual([...curve.x], [0, 1, 2, 3, 4]);
    assert.deepEqual([...curve.y], [1, 3, 2, 4, 2]);
    assert.deepEqual(curve.line, [
      { x: 0, y: 1 },
      { x: 1, y: 1 },
      { x: 1, y: 3 },
      { x: 3, y: 3 },
      { x: 3, y: 4 },
      { x: 4, y: 4 },
    ]);
    assert.deepEqual([curve.level, curve.best, curve.chosen], [1, 3, 2]);
  });

  it('has a point without a score for what failed, and nothing before the first evaluation', () => {
    const { store, ranking } = searchWith([NaN, 2]);
    const curve = learningCurve({ store, ranking, chosen: 7, hasBaseline: true });
    assert.ok(Number.isNaN(curve.y[0]));
    assert.deepEqual([curve.level, curve.chosen], [null, null]);
    assert.deepEqual(learningCurve({ ...searchWith([]), chosen: null, hasBaseline: true }).line, []);
  });
});

describe('a dimension against the score', () => {
  it('shows all values that it may have', () => {
    const { store, ranking } = searchWith([1, 3, 2]);
    const chart = valueChart({ store, ranking, chosen: null, hasBaseline: true }, 0, { lowest: 0, highest: 40 });
    assert.deepEqual([...chart.x], [0, 1, 2]);
    assert.deepEqual(chart.xRange, [-2, 42]);
    assert.deepEqual([chart.line, chart.level], [[], null]);
  });
});
