// Smallest and largest values of blocks of rows, so that a long time window costs as much to draw as it has pixels.

import { noValue } from '../wire/messages.js';

// Rows in a block of each level. The capacity of a ring must be a multiple of the largest.
const blockRows = [16, 256, 4096];

export const pyramidBlock = blockRows[blockRows.length - 1] as number;

const emptyMinimum = 2147483647;

interface Level {
  rows: number;
  blocks: number;
  minima: Int32Array; // blocks * count
  maxima: Int32Array;
}

// The smallest and the largest value of a range; `maximum` is noValue if the range has no values.
export interface Range {
  minimum: number;
  maximum: number;
}

export class MinMaxPyramid {
  private readonly levels: Level[];

  constructor(
    private readonly values: Int32Array, // values of the ring: capacity * count
    private readonly capacity: number,
    private readonly count: number,
  ) {
    if (capacity % pyramidBlock !== 0) {
      throw new RangeError(`pyramid: found a capacity of ${capacity} rows, expected a multiple of ${pyramidBlock}`);
    }
    this.levels = blockRows.map((rows) => {
      const blocks = capacity / rows;
      return {
        rows,
        blocks,
        minima: new Int32Array(blocks * count).fill(emptyMinimum),
        maxima: new Int32Array(blocks * count).fill(noValue),
      };
    });
  }

  // Adds the row that has just been written. Rows are numbered from 0 and come one after another.
  append(row: number): void {
    const source = (row % this.capacity) * this.count;
    for (const { rows, blocks, minima, maxima } of this.levels) {
      const target = (Math.floor(row / rows) % blocks) * this.count;
      const isFirst = row % rows === 0;
      for (let i = 0; i < this.count; i += 1) {
        const value = this.values[source + i] as number;
        const isNone = value === noValue;
        if (isFirst) {
          minima[target + i] = isNone ? emptyMinimum : value;
          maxima[target + i] = value;
        } else if (!isNone) {
          if (value < (minima[target + i] as number)) minima[target + i] = value;
          if (value > (maxima[target + i] as number)) maxima[target + i] = value;
        }
      }
    }
  }

  // The range of value `index` in the rows from `from` up to, not including, `to`; all of them must still be in the ring.
  rangeOf(index: number, from: number, to: number): Range {
    let minimum = emptyMinimum;
    let maximum = noValue;
    for (let row = from; row < to; ) {
      const level = this.largestBlockAt(row, to);
      let low: number;
      let high: number;
      if (level === null) {
        high = this.values[(row % this.capacity) * this.count + index] as number;
        low = high === noValue ? emptyMinimum : high;
        row += 1;
      } else {
        const at = (Math.floor(row / level.rows) % level.blocks) * this.count + index;
        low = level.minima[at] as number;
        high = level.maxima[at] as number;
        row += level.rows;
      }
      if (low < minimum) minimum = low;
      if (high > maximum) maximum = high;
    }
    return { minimum, maximum };
  }

  private largestBlockAt(row: number, to: number): Level | null {
    for (let i = this.levels.length - 1; i >= 0; i -= 1) {
      const level = this.levels[i] as Level;
      if (row % level.rows === 0 && row + level.rows <= to) {
        return level;
      }
    }
    return null;
  }
}
