// The map of gaits of a search with MAP-Elites, kept while rows come in: the best candidate of each cell, by the definition of
// docs/optimisation-files.md. A row that failed, or lacks a measure of an axis, is in no cell; of equal ones the first stays.
import type { MapAxis } from '../../wire/messages.js';
import { otherHasNoScore } from '../../wire/search_messages.js';
import type { RowStore } from './row_store.js';

export interface MapPlace {
  x: number; // of the middle of the cell on the first two axes: 0 at the lowest, 1 at the highest value
  y: number;
}

export class GaitMap {
  readonly elites = new Map<number, number>(); // rows by cell
  readonly cellCount: number;
  private done = 0;
  private clears = 0;

  constructor(
    private readonly store: RowStore,
    readonly axes: readonly MapAxis[],
    readonly centroids: readonly (readonly number[])[] | null,
    private readonly maximise: boolean,
  ) {
    this.cellCount = centroids?.length ?? axes.reduce((count, { cells }) => count * cells, 1);
  }

  // Takes the rows that are new in the store.
  update(): void {
    if (this.store.clears !== this.clears) {
      this.clears = this.store.clears;
      this.done = 0;
      this.elites.clear();
    }
    for (; this.done < this.store.count; this.done += 1) this.take(this.done);
  }

  scoreOf(cell: number): number {
    const row = this.elites.get(cell);
    return row === undefined ? NaN : this.store.scoreOf(row, 0);
  }

  // The numbers of the cell on the axes, or that of its centroid, from 1, as files and commands have them.
  nameOf(cell: number): string {
    return (this.centroids === null ? this.numbersOf(cell) : [cell]).map((number) => number + 1).join();
  }

  // null: the map has no such cell.
  cellNamed(name: string): number | null {
    const numbers = name.split(',').map((text) => Number(text) - 1);
    const counts = this.centroids === null ? this.axes.map(({ cells }) => cells) : [this.cellCount];
    if (numbers.length !== counts.length || numbers.some((number, i) => !Number.isInteger(number) || number < 0 || number >= counts[i]!)) return null;
    return numbers.reduce((cell, number, i) => cell * counts[i]! + number, 0);
  }

  placeOf(cell: number): MapPlace {
    const centroid = this.centroids?.[cell];
    if (centroid !== undefined) return { x: centroid[0]!, y: centroid[1]! };
    const [x, y] = this.numbersOf(cell).map((number, axis) => (number + 0.5) / this.axes[axis]!.cells);
    return { x: x!, y: y! };
  }

  private numbersOf(cell: number): number[] {
    const numbers: number[] = [];
    let rest = cell;
    for (const { cells } of [...this.axes].reverse()) {
      numbers.unshift(rest % cells);
      rest = Math.floor(rest / cells);
    }
    return numbers;
  }

  private take(row: number): void {
    if (!this.store.hasScore(row, 0) || this.store.has(row, otherHasNoScore)) return;
    const cell = this.cellOf(row);
    if (cell === null) return;
    const gain = this.store.scoreOf(row, 0) - this.scoreOf(cell);
    if (Number.isNaN(gain) || (this.maximise ? gain > 0 : gain < 0)) this.elites.set(cell, row);
  }

  private cellOf(row: number): number | null {
    const shares = this.axes.map(({ lowest, highest }, axis) => (this.store.scoreOf(row, 1 + axis) - lowest) / (highest - lowest));
    if (shares.some(Number.isNaN)) return null;
    if (this.centroids !== null) return nearest(this.centroids, shares.map((share) => Math.max(0, Math.min(1, share))));
    return shares.reduce((cell, share, axis) => {
      const { cells } = this.axes[axis]!;
      return cell * cells + Math.floor(Math.max(0, Math.min(cells - 1, share * cells)));
    }, 0);
  }
}

function nearest(centroids: readonly (readonly number[])[], point: readonly number[]): number | null {
  let [best, least] = [null as number | null, Infinity];
  for (let number = 0; number < centroids.length; number += 1) {
    const centroid = centroids[number]!;
    let distance = 0;
    for (let axis = 0; axis < point.length; axis += 1) distance += (point[axis]! - centroid[axis]!) ** 2;
    if (distance < least) [best, least] = [number, distance];
  }
  return best;
}
