// What a sweep has measured: for each combination without the seed the mean over the seeds.
import type { OpenedSweep, SweepCells, SweptQuantity } from '../../wire/messages.js';

export interface Cells {
  made: number; // runs that they have
  mean: Float64Array; // NaN: no run has a value
  deviation: Float64Array; // NaN below two values
  values: Uint32Array; // number of them
  failed: Uint32Array; // runs without a value
}

export function emptyCells(count: number): Cells {
  return { made: 0, mean: new Float64Array(count).fill(NaN), deviation: new Float64Array(count).fill(NaN), values: new Uint32Array(count), failed: new Uint32Array(count) };
}

export function takeCells(cells: Cells, { from, made, cells: rows }: SweepCells): void {
  cells.made = made;
  for (const [place, [mean, deviation, values, failed]] of rows.entries()) {
    const cell = from + place;
    if (cell >= cells.mean.length) return;
    cells.mean[cell] = mean ?? NaN;
    cells.deviation[cell] = deviation ?? NaN;
    cells.values[cell] = values;
    cells.failed[cell] = failed;
  }
}

// null: no cell has a value. Of equal ones the first.
export function bestCell({ mean }: Cells, higherIsBetter: boolean): number | null {
  let best: number | null = null;
  for (const [cell, value] of mean.entries()) {
    if (Number.isNaN(value)) continue;
    const other = best === null ? NaN : mean[best]!;
    if (best === null || (higherIsBetter ? value > other : value < other)) best = cell;
  }
  return best;
}

// The quantities that a cell has a value of.
export function cellQuantities({ quantities }: Pick<OpenedSweep, 'quantities'>): SweptQuantity[] {
  return quantities.filter((quantity) => !quantity.is_seed);
}

export function seedCount({ quantities }: Pick<OpenedSweep, 'quantities'>): number {
  return quantities.find(({ is_seed: isSeed }) => isSeed)?.values.length ?? 1;
}

// The axes of the picture.
export function variedQuantities(opened: Pick<OpenedSweep, 'quantities'>): SweptQuantity[] {
  return cellQuantities(opened).filter(({ values }) => values.length > 1);
}

// The positions of the values of a cell; the last quantity varies fastest.
export function placesOf(quantities: readonly SweptQuantity[], cell: number): number[] {
  const places: number[] = [];
  let rest = cell;
  for (const { values } of [...quantities].reverse()) {
    places.unshift(rest % values.length);
    rest = Math.floor(rest / values.length);
  }
  return places;
}

// The lowest and the highest mean; null: there is none.
export function meanRange({ mean }: Cells): [number, number] | null {
  let [low, high] = [Infinity, -Infinity];
  for (const value of mean) {
    if (Number.isNaN(value)) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  return low <= high ? [low, high] : null;
}
