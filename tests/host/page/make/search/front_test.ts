import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { frontChart } from '../../../../../host/page/source/make/search/chart_content.js';
import { Front } from '../../../../../host/page/source/make/search/front.js';
import { Ranking } from '../../../../../host/page/source/make/search/ranking.js';
import { RowStore } from '../../../../../host/page/source/make/search/row_store.js';
import { Random } from '../../support/random.js';

type Pair = [number, number];

function frontOf(scores: readonly Pair[], maximise: [boolean, boolean], { flags, values }: { flags?: number[]; values?: number[] } = {}) {
  const store = new RowStore(2, 1);
  const front = new Front(store, maximise);
  scores.forEach((pair, row) => {
    store.append({ from: row, made: scores.length, scores: [pair], values: [[values?.[row] ?? row]], flags: [flags?.[row] ?? 0] });
    if (row % 3 === 0) front.update();
  });
  front.update();
  return { store, front };
}

// By the definition: nothing is at least as good in both and better in one.
function nonDominated(scores: readonly Pair[], maximise: [boolean, boolean]): number[] {
  const gains = scores.map((pair) => pair.map((score, i) => (maximise[i] ? score : -score)));
  const rows = scores.map((_, row) => row).filter((row) => !gains.some(([a, b]) => a! >= gains[row]![0]! && b! >= gains[row]![1]! && (a! > gains[row]![0]! || b! > gains[row]![1]!)));
  return rows.sort((a, b) => scores[a]![0] - scores[b]![0] || a - b);
}

describe('the Pareto front', () => {
  it('has the candidates that no other dominates, whichever way is better', () => {
    for (let seed = 1; seed <= 40; seed += 1) {
      const random = new Random(seed);
      const scores = Array.from({ length: 200 }, (): Pair => [random.integer(-30, 30), random.integer(-30, 30)]);
      const maximise: [boolean, boolean] = [random.next() < 0.5, random.next() < 0.5];
      assert.deepEqual(frontOf(scores, maximise).front.rows, nonDominated(scores, maximise), `seed ${seed}`);
    }
  });

  it('has no candidate that failed or has no score for one of the objectives', () => {
    const [failed, otherFailed] = [1, 8];
    assert.deepEqual(frontOf([[9, 9], [8, 8], [1, 2], [2, 1]], [true, true], { flags: [failed, otherFailed, 0, 0] }).front.rows, [2, 3]);
  });

  it('has equal candidates once, and different ones with equal scores each', () => {
    assert.deepEqual(frontOf([[1, 1], [1, 1], [1, 1]], [true, true], { values: [5, 5, 6] }).front.rows, [0, 2]);
  });

  it('begins anew when the rows do', () => {
    const { store, front } = frontOf([[1, 2], [2, 1]], [true, true]);
    store.clear();
    store.append({ from: 0, made: 1, scores: [[0, 0]], values: [[0]], flags: [0] });
    front.update();
    assert.deepEqual(front.rows, [0]);
  });

  it('is drawn as the border of what it dominates, with all its points in sight', () => {
    for (const maximise of [[true, true], [false, true], [true, false], [false, false]] as [boolean, boolean][]) {
      const sign = maximise.map((is) => (is ? 1 : -1));
      const scores = [[1, 3], [2, 2], [3, 1], [0, 0]].map(([a, b]): Pair => [a! * sign[0]!, b! * sign[1]!]);
      const { store, front } = frontOf(scores, maximise);
      const ranking = new Ranking(store, 0, maximise[0]);
      ranking.update();
      const chart = frontChart({ store, ranking, chosen: 2, hasBaseline: false }, front, maximise);
      const steps = chart.line.map(({ x, y }) => [x * sign[0]!, y * sign[1]!]);
      assert.deepEqual(steps.slice(1, -1), [[1, 3], [1, 2], [2, 2], [2, 1], [3, 1]], String(maximise));
      assert.ok(steps[0]![0]! < 0 && steps.at(-1)![1]! < 0, 'it goes on to the edges');
      assert.deepEqual([...chart.marked].sort(), [0, 1, 2]);
      assert.equal(chart.chosen, 2);
      assert.deepEqual(chart.rows, [0, 1, 2, 3]);
    }
  });
});
