import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { cellAt } from '../../../../../host/page/source/make/sweep/picture_drawing.js';
import { bestCell, emptyCells, meanRange, placesOf, takeCells, variedQuantities } from '../../../../../host/page/source/make/sweep/sweep_cells.js';
import { cellName, cellText } from '../../../../../host/page/source/make/sweep/sweep_text.js';

const quantity = (name: string, unit: string, values: string[], isSeed = false) => ({ name, unit, values, is_seed: isSeed });
const opened = { quantities: [quantity('amplitude', 'deg', ['10', '20', '30']), quantity('seed', '', ['1', '2'], true), quantity('friction', '', ['0.1', '0.2'])] };

function cellsOf(means: (number | null)[]) {
  const cells = emptyCells(means.length);
  takeCells(cells, { from: 0, made: means.length, cells: means.map((mean) => [mean, null, mean === null ? 0 : 1, mean === null ? 1 : 0]) });
  return cells;
}

describe('the cells of a sweep', () => {
  it('are counted without the seed, the last quantity the fastest', () => {
    assert.deepEqual([0, 1, 2, 5].map((cell) => cellName(opened, cell)), ['amplitude 10 deg, friction 0.1', 'amplitude 10 deg, friction 0.2', 'amplitude 20 deg, friction 0.1', 'amplitude 30 deg, friction 0.2']);
    assert.deepEqual(placesOf(opened.quantities.filter((each) => !each.is_seed), 3), [1, 1]);
    assert.deepEqual(variedQuantities(opened).map(({ name }) => name), ['amplitude', 'friction']);
  });

  it('come in several answers', () => {
    const cells = emptyCells(3);
    takeCells(cells, { from: 0, made: 2, cells: [[1, 0.5, 2, 0]] });
    takeCells(cells, { from: 1, made: 5, cells: [[null, null, 0, 2], [3, null, 1, 1], [9, null, 1, 0]] });
    assert.equal(cells.made, 5);
    assert.deepEqual([...cells.mean], [1, NaN, 3]);
    assert.equal(cellText(cells, 0, 'm'), '1 m (standard deviation 0.5, 2 values)');
    assert.equal(cellText(cells, 1, 'm'), '2 runs failed or without a value');
    assert.equal(cellText(cells, 2, ''), '3 (1 run failed or without a value)');
    assert.equal(cellText(emptyCells(1), 0, 'm'), 'not simulated yet');
  });

  it('have a best one, the first of equal ones, if any has a value', () => {
    assert.equal(bestCell(cellsOf([null, 2, 5, 5]), true), 2);
    assert.equal(bestCell(cellsOf([null, 2, 1, 1]), false), 2);
    assert.equal(bestCell(cellsOf([null, null]), true), null);
    assert.equal(meanRange(cellsOf([null])), null);
    assert.deepEqual(meanRange(cellsOf([3, null, -1])), [-1, 3]);
  });

  it('are where the picture has them', () => {
    const size = { width: 62 + 12 + 300, height: 10 + 36 + 200 };
    const axes = variedQuantities(opened);
    assert.equal(cellAt(axes, size, { x: 63, y: 209 }), 0);
    assert.equal(cellAt(axes, size, { x: 63, y: 11 }), 1);
    assert.equal(cellAt(axes, size, { x: 361, y: 11 }), 5);
    assert.equal(cellAt(axes, size, { x: 61, y: 100 }), null);
    assert.equal(cellAt(axes, size, { x: 100, y: 211 }), null);
    const line = axes.slice(0, 1);
    assert.deepEqual([63, 62 + 150, 361].map((x) => cellAt(line, size, { x, y: 50 })), [0, 1, 2]);
  });
});
