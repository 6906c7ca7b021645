// The Pareto front of a search with two objectives, kept while rows come in. As in the picture of the search's folder
// (sim/optimize/report/pareto.cpp), a row that failed is not on it, and a candidate that came again is there once.
import { otherHasNoScore } from '../../wire/search_messages.js';
import type { RowStore } from './row_store.js';

export class Front {
  // Rows that no other is better than in one score and not worse in the other, by ascending first score.
  readonly rows: number[] = [];
  private done = 0;
  private clears = 0;

  // maximise: whether a higher score is better, of the two objectives.
  constructor(
    private readonly store: RowStore,
    private readonly maximise: readonly [boolean, boolean],
  ) {}

  // Takes the rows that are new in the store.
  update(): void {
    if (this.store.clears !== this.clears) {
      this.clears = this.store.clears;
      this.done = 0;
      this.rows.length = 0;
    }
    for (; this.done < this.store.count; this.done += 1) this.take(this.done);
  }

  hasScores(row: number): boolean {
    return this.store.hasScore(row, 0) && this.store.hasScore(row, 1) && !this.store.has(row, otherHasNoScore);
  }

  private take(row: number): void {
    if (!this.hasScores(row) || this.rows.some((other) => this.isNothingNew(row, other))) return;
    const kept = this.rows.filter((other) => !this.dominates(row, other));
    const place = kept.findIndex((other) => this.store.scoreOf(other, 0) > this.store.scoreOf(row, 0));
    kept.splice(place < 0 ? kept.length : place, 0, row);
    this.rows.splice(0, this.rows.length, ...kept);
  }

  // Whether a row has no place beside one of the front: it is dominated, or the same candidate with the same scores.
  private isNothingNew(row: number, other: number): boolean {
    if (this.dominates(other, row)) return true;
    const { store } = this;
    const isEqual = (value: (of: number) => number) => value(row) === value(other);
    if (!isEqual((of) => store.scoreOf(of, 0)) || !isEqual((of) => store.scoreOf(of, 1))) return false;
    return Array.from({ length: store.dimensions }, (_, dimension) => dimension).every((dimension) => isEqual((of) => store.valueOf(of, dimension)));
  }

  private dominates(row: number, other: number): boolean {
    const gains = this.maximise.map((maximise, objective) => {
      const gain = this.store.scoreOf(row, objective) - this.store.scoreOf(other, objective);
      return maximise ? gain : -gain;
    });
    return gains.every((gain) => gain >= 0) && gains.some((gain) => gain > 0);
  }
}
