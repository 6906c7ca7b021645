import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { MinMaxPyramid, pyramidBlock } from '../../../../host/page/source/data/min_max_pyramid.js';
import { noValue } from '../../../../host/page/source/wire/messages.js';
import { Random } from '../support/random.js';

const seed = 20131;

describe('the pyramid of minima and maxima', () => {
  it(`gives what a search of all rows gives, also after the ring has wrapped (seed ${seed})`, () => {
    const random = new Random(seed);
    const count = 3;
    const capacity = pyramidBlock;
    const values = new Int32Array(capacity * count).fill(noValue);
    const pyramid = new MinMaxPyramid(values, capacity, count);
    const rows = capacity * 2 + 777;
    for (let row = 0; row < rows; row += 1) {
      for (let i = 0; i < count; i += 1) {
        const isNone = random.next() < 0.05;
        values[(row % capacity) * count + i] = isNone ? noValue : random.integer(-2147483647, 2147483647);
      }
      pyramid.append(row);
    }
    for (let trial = 0; trial < 300; trial += 1) {
      const from = random.integer(rows - capacity, rows - 1);
      const to = random.integer(from, rows);
      const index = random.integer(0, count - 1);
      let minimum = 2147483647;
      let maximum = noValue;
      for (let row = from; row < to; row += 1) {
        const value = values[(row % capacity) * count + index] as number;
        if (value !== noValue) {
          minimum = Math.min(minimum, value);
          maximum = Math.max(maximum, value);
        }
      }
      assert.deepEqual(pyramid.rangeOf(index, from, to), { minimum, maximum }, `rows ${from} to ${to}`);
    }
  });

  it('says that a range has no values', () => {
    const values = new Int32Array(pyramidBlock).fill(noValue);
    const pyramid = new MinMaxPyramid(values, pyramidBlock, 1);
    pyramid.append(0);
    assert.equal(pyramid.rangeOf(0, 0, 1).maximum, noValue);
    assert.equal(pyramid.rangeOf(0, 0, 0).maximum, noValue);
  });

  it('rejects a capacity that its largest blocks do not fill', () => {
    assert.throws(() => new MinMaxPyramid(new Int32Array(100), 100, 1), /found a capacity of 100 rows/);
  });
});
