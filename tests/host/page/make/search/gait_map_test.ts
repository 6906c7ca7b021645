import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { bestTrial, trialCells, trialRow } from '../../../../../host/page/source/make/search/adaptation_trials.js';
import { GaitMap } from '../../../../../host/page/source/make/search/gait_map.js';
import { filledCellAt, nextFilledCell, scoreRange } from '../../../../../host/page/source/make/search/map_drawing.js';
import { RowStore } from '../../../../../host/page/source/make/search/row_store.js';
import type { AdaptationTrial } from '../../../../../host/page/source/wire/messages.js';
import { Random } from '../../support/random.js';

type Row = [score: number | null, ...measures: (number | null)[]];

const height = { name: 'height', unit: 'm', lowest: 1, highest: 3, cells: 4 };
const duty = { name: 'duty_factor', unit: '', lowest: 0, highest: 1, cells: 2 };
const noScore = 1;
const noMeasure = 8;

function mapOf(rows: readonly Row[], { axes = [height, duty], centroids = null, maximise = true, flags = [] }: { axes?: (typeof height)[]; centroids?: number[][] | null; maximise?: boolean; flags?: number[] } = {}) {
  const store = new RowStore(1 + axes.length, 1);
  const map = new GaitMap(store, axes, centroids, maximise);
  rows.forEach((scores, row) => {
    store.append({ from: row, made: rows.length, scores: [scores], values: [[row / 4]], flags: [flags[row] ?? 0] });
    if (row % 3 === 0) map.update();
  });
  map.update();
  return { store, map };
}

const cells = (map: GaitMap) => [...map.elites].map(([cell, row]) => [map.nameOf(cell), row]);

describe('the map of gaits', () => {
  it('has the best row of each cell of the grid; the first of equal ones', () => {
    assert.deepEqual(cells(mapOf([[1, 1.2, 0.1], [2, 1.4, 0.4], [2, 1.3, 0.3], [0.5, 2.6, 0.7]]).map), [['1,1', 1], ['4,2', 3]]);
    assert.deepEqual(cells(mapOf([[1, 1.2, 0.1], [2, 1.4, 0.4]], { maximise: false }).map), [['1,1', 0]]);
  });

  it('puts what is beyond an axis into its first or last cell', () => {
    assert.deepEqual(cells(mapOf([[1, -5, 7], [1, 9, -0.1], [1, 3, 1]]).map), [['1,2', 0], ['4,1', 1], ['4,2', 2]]);
  });

  it('has no row that failed or lacks a measure', () => {
    assert.deepEqual(cells(mapOf([[9, 2, 0.5], [9, 2, 0.5], [null, 2, 0.5], [9, 2, null], [1, 2, 0.5]], { flags: [noScore, noMeasure] }).map), [['3,2', 4]]);
  });

  it('puts a row into the cell of the nearest centroid', () => {
    for (let seed = 1; seed <= 20; seed += 1) {
      const random = new Random(seed);
      const centroids = Array.from({ length: 12 }, () => [random.next(), random.next()]);
      const rows = Array.from({ length: 60 }, (): Row => [random.next(), 1 + 2 * random.next(), random.next()]);
      const { map } = mapOf(rows, { centroids, axes: [{ ...height, cells: 0 }, { ...duty, cells: 0 }] });
      for (const [cell, row] of map.elites) {
        const [score, x, y] = rows[row] as [number, number, number];
        const distances = centroids.map(([cx, cy]) => Math.hypot((x - 1) / 2 - cx!, y - cy!));
        assert.equal(distances.indexOf(Math.min(...distances)), cell, `seed ${seed}`);
        assert.ok(rows.every(([other, ox, oy]) => {
          const of = centroids.map(([cx, cy]) => Math.hypot((ox! - 1) / 2 - cx!, oy! - cy!));
          return other! <= score || of.indexOf(Math.min(...of)) !== cell;
        }), `seed ${seed}`);
      }
    }
  });

  it('gives each cell a name, and finds it by that', () => {
    const { map } = mapOf([], { axes: [height, duty, { ...duty, name: 'roll', cells: 5 }] });
    assert.equal(map.cellCount, 40);
    const names = Array.from({ length: 40 }, (_, cell) => map.nameOf(cell));
    assert.equal(new Set(names).size, 40);
    names.forEach((name, cell) => assert.equal(map.cellNamed(name), cell));
    for (const wrong of ['', '1', '1,1', '5,1,1', '0,1,1', '1,1,6', '1,1,1,1', 'a,1,1', '1.5,1,1']) assert.equal(map.cellNamed(wrong), null, wrong);
    const { map: other } = mapOf([], { centroids: [[0, 0], [1, 1]], axes: [{ ...height, cells: 0 }, { ...duty, cells: 0 }] });
    assert.deepEqual([other.nameOf(1), other.cellNamed('2'), other.cellNamed('3')], ['2', 1, null]);
  });

  it('begins anew when the rows do', () => {
    const { store, map } = mapOf([[5, 1.2, 0.1]]);
    store.clear();
    store.append({ from: 0, made: 1, scores: [[1, 2.9, 0.9]], values: [[0]], flags: [0] });
    map.update();
    assert.deepEqual(cells(map), [['4,2', 0]]);
  });

  it('says which cell is where it was drawn, for the mouse', () => {
    const size = { width: 474, height: 246 }; // cells of 100 by 100 pixels
    const { map } = mapOf([[1, 1.2, 0.1], [2, 2.6, 0.7]]);
    const at = (x: number, y: number) => filledCellAt(map, true, size, { x, y });
    assert.equal(at(62 + 50, 10 + 150), map.cellNamed('1,1'));
    assert.equal(at(62 + 350, 10 + 50), map.cellNamed('4,2'));
    assert.equal(at(62 + 150, 10 + 150), null, 'an empty cell');
    assert.equal(at(5, 5), null);
    assert.deepEqual(scoreRange(map), [1, 2]);
    assert.equal(scoreRange(mapOf([]).map), null);
  });

  it('has the best in front where cells of a third axis are at one place', () => {
    const { map } = mapOf([[3, 1.2, 0.1, 0.1], [4, 1.2, 0.1, 0.9], [2, 1.2, 0.1, 0.5]], { axes: [height, duty, { ...duty, name: 'roll', cells: 3 }] });
    assert.equal(map.elites.get(filledCellAt(map, true, { width: 474, height: 246 }, { x: 112, y: 160 })!), 1);
  });

  it('goes with the arrow keys to the next filled cell of a direction, and stays where there is none', () => {
    const { map } = mapOf([[1, 1.2, 0.1], [2, 2.6, 0.1], [3, 2.6, 0.9]]);
    const go = (from: string, step: [number, number]) => map.nameOf(nextFilledCell(map, map.cellNamed(from)!, step));
    assert.equal(go('1,1', [1, 0]), '4,1');
    assert.equal(go('4,1', [-1, 0]), '1,1');
    assert.equal(go('4,1', [0, 1]), '4,2');
    assert.equal(go('4,2', [0, 1]), '4,2');
  });
});

describe('the trials of an adaptation', () => {
  const trial = (cell: string, measured: number, more: Partial<AdaptationTrial> = {}): AdaptationTrial => ({ cell, values: [0], expected: 1, deviation: 0.1, measured, failure: null, ...more });

  it('have the best one of those that have a score; the first of equal ones', () => {
    const trials = [trial('1,1', 9, { failure: 'it fell' }), trial('1,1', 1), trial('1,1', 2), trial('1,1', 2)];
    assert.equal(bestTrial({ trials }, true), 2);
    assert.equal(bestTrial({ trials }, false), 1);
    assert.equal(bestTrial({ trials: [] }, true), null);
  });

  it('are drawn on their cells, of several on one cell the last', () => {
    const { map } = mapOf([[1, 1.2, 0.1], [2, 2.6, 0.7]]);
    const trials = [trial('4,2', 3), trial('1,1', 1), trial('4,2', 2), trial('9,9', 1)];
    assert.deepEqual(trialCells({ trials }, map, true), [
      { number: 3, cell: map.cellNamed('4,2'), isBest: true },
      { number: 2, cell: map.cellNamed('1,1'), isBest: false },
    ]);
  });

  it('have the first evaluation of the gait that they tried, also if it is not the best of its cell', () => {
    const { map, store } = mapOf([[1, 1.2, 0.1], [2, 2.6, 0.7], [3, 2.6, 0.7]]);
    assert.equal(map.elites.get(map.cellNamed('4,2')!), 2);
    assert.equal(trialRow({ values: [0.25] }, store), 1);
    assert.equal(trialRow({ values: [0.125] }, store), null);
    assert.equal(trialRow({ values: [0.25, 1] }, store), null);
  });
});
