// The evaluations of a search as columns of numbers, which grow with the search: a hundred thousand of them are a few megabytes.
import { hasNoScore, type SearchRows } from '../../wire/search_messages.js';

const firstCapacity = 1024; // rows
const mostNumbers = 2 ** 25; // of all dimensions: 128 MiB

function grown<Column extends Float32Array | Float64Array | Uint8Array>(column: Column, larger: Column): Column {
  larger.set(column);
  return larger;
}

export class RowStore {
  count = 0; // rows; row n is evaluation n
  clears = 0; // how often all rows were forgotten
  readonly capacity: number; // later evaluations are left out
  private scores: Float64Array[];
  private values: Float32Array[]; // for pictures and tables: a candidate that is chosen has its exact values
  private flags = new Uint8Array(firstCapacity);

  constructor(
    readonly objectives: number,
    readonly dimensions: number,
  ) {
    this.capacity = Math.floor(mostNumbers / Math.max(1, dimensions));
    this.scores = Array.from({ length: objectives }, () => new Float64Array(firstCapacity));
    this.values = Array.from({ length: dimensions }, () => new Float32Array(firstCapacity));
  }

  get isFull(): boolean {
    return this.count >= this.capacity;
  }

  clear(): void {
    this.count = 0;
    this.clears += 1;
  }

  // Adds the rows of an answer. Throws an Error if they do not follow the last one, or have another form.
  append({ from, scores, values, flags }: SearchRows): void {
    if (from !== this.count) {
      throw new Error(`evaluations: found those from ${from} on, expected those from ${this.count} on`);
    }
    if (values.length !== scores.length || flags.length !== scores.length) {
      throw new Error(`evaluations: found ${values.length} values and ${flags.length} flags, expected ${scores.length}`);
    }
    const added = Math.min(scores.length, this.capacity - this.count);
    this.reserve(this.count + added);
    for (let i = 0; i < added; i += 1) {
      const row = this.count + i;
      for (let objective = 0; objective < this.objectives; objective += 1) {
        this.scores[objective]![row] = scores[i]![objective] ?? NaN;
      }
      for (let dimension = 0; dimension < this.dimensions; dimension += 1) {
        this.values[dimension]![row] = values[i]![dimension] ?? NaN;
      }
      this.flags[row] = flags[i]!;
    }
    this.count += added;
  }

  // NaN if there is none.
  scoreOf(row: number, objective: number): number {
    return row < this.count ? (this.scores[objective]?.[row] ?? NaN) : NaN;
  }

  valueOf(row: number, dimension: number): number {
    return row < this.count ? (this.values[dimension]?.[row] ?? NaN) : NaN;
  }

  has(row: number, flag: number): boolean {
    return row < this.count && (this.flags[row]! & flag) !== 0;
  }

  // Whether an evaluation has a score of its own: it did not fail.
  hasScore(row: number, objective: number): boolean {
    return !this.has(row, hasNoScore) && !Number.isNaN(this.scoreOf(row, objective));
  }

  private reserve(rows: number): void {
    let size = this.flags.length;
    if (rows <= size) return;
    while (size < rows) size *= 2;
    this.flags = grown(this.flags, new Uint8Array(size));
    this.scores = this.scores.map((column) => grown(column, new Float64Array(size)));
    this.values = this.values.map((column) => grown(column, new Float32Array(size)));
  }
}
