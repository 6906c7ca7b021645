// The best evaluations of a search by one objective, kept while rows come in.
import { wasGivenUp, wasKnown } from '../../wire/search_messages.js';
import type { RowStore } from './row_store.js';

export const mostRanked = 20;

export class Ranking {
  // Rows, the best first. A candidate is there once; what failed or was given up comes behind all that was completed.
  readonly best: number[] = [];
  // The rows that were better than all before them: the line of the best so far.
  readonly records: number[] = [];
  private done = 0;
  private clears = 0;

  constructor(
    private readonly store: RowStore,
    readonly objective: number,
    readonly maximise: boolean,
  ) {}

  // Takes the rows that are new in the store.
  update(): void {
    if (this.store.clears !== this.clears) {
      this.clears = this.store.clears;
      this.done = 0;
      this.best.length = 0;
      this.records.length = 0;
    }
    for (; this.done < this.store.count; this.done += 1) this.take(this.done);
  }

  private take(row: number): void {
    const record = this.records.at(-1);
    if (this.gradeOf(row) === 0 && (record === undefined || this.compare(row, record) < 0)) this.records.push(row);
    if (this.store.has(row, wasKnown)) return;
    const last = this.best.at(-1);
    if (this.best.length === mostRanked && last !== undefined && this.compare(row, last) > 0) return;
    const place = this.best.findIndex((other) => this.compare(row, other) < 0);
    this.best.splice(place < 0 ? this.best.length : place, 0, row);
    this.best.length = Math.min(this.best.length, mostRanked);
  }

  // 0: completed, 1: given up, with an extrapolated score, 2: failed.
  private gradeOf(row: number): number {
    if (!this.store.hasScore(row, this.objective)) return 2;
    return this.store.has(row, wasGivenUp) ? 1 : 0;
  }

  // Below 0: the first one is better. Of equal ones the earlier is.
  private compare(first: number, second: number): number {
    const grades = this.gradeOf(first) - this.gradeOf(second);
    if (grades !== 0) return grades;
    const difference = this.store.scoreOf(first, this.objective) - this.store.scoreOf(second, this.objective);
    if (difference !== 0 && !Number.isNaN(difference)) return this.maximise ? -difference : difference;
    return first - second;
  }
}

// A column of the table of candidates: their numbers, a score or a value.
export type SortColumn = { kind: 'number' } | { kind: 'score' | 'value'; index: number };

// The rows in the order of a column; what has no number there is last.
export function sortedBy(store: RowStore, rows: readonly number[], column: SortColumn, isDescending: boolean): number[] {
  const keyOf = (row: number) => {
    if (column.kind === 'number') return row;
    if (column.kind === 'value') return store.valueOf(row, column.index);
    return store.hasScore(row, column.index) ? store.scoreOf(row, column.index) : NaN;
  };
  return [...rows].sort((first, second) => {
    const [a, b] = [keyOf(first), keyOf(second)];
    if (Number.isNaN(a) || Number.isNaN(b)) return Number(Number.isNaN(a)) - Number(Number.isNaN(b)) || first - second;
    return (isDescending ? b - a : a - b) || first - second;
  });
}
