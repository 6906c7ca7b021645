// Reads the evaluations of a search: all that there are at once, in several answers, then the new ones once a second.
import { signal } from '@preact/signals-core';
import type { SearchRows } from '../../wire/messages.js';
import { RowStore } from './row_store.js';

const period = 1000; // milliseconds between two questions for new rows, and after a refusal

export class RowReader {
  readonly problem = signal<string | null>(null);
  private made = 0; // evaluations of the search, as the last answer says
  private askedAt = -Infinity;
  private isAsking = false;
  private isClosed = false;

  constructor(
    readonly store: RowStore,
    private readonly ask: (from: number) => Promise<SearchRows>,
  ) {}

  // What comes later is not read any more.
  close(): void {
    this.isClosed = true;
  }

  // To be called at each frame while the search is shown. `announced`: evaluations that the search has at least.
  advance(now: number, announced: number, isRunning: boolean): void {
    if (this.isAsking || this.isClosed || this.store.isFull) return;
    const { count } = this.store;
    const isBehind = this.problem.peek() === null && count < this.made;
    const isFirst = this.askedAt === -Infinity;
    const isDue = now - this.askedAt >= period && (isFirst || isRunning || count < announced || this.problem.peek() !== null);
    if (!isBehind && !isDue) return;
    this.askedAt = now;
    void this.read();
  }

  private async read(): Promise<void> {
    this.isAsking = true;
    try {
      const rows = await this.ask(this.store.count);
      if (this.isClosed) return;
      if (rows.made < this.store.count) {
        // Another search has come into the folder.
        this.store.clear();
      } else {
        this.store.append(rows);
      }
      this.made = rows.scores.length === 0 ? this.store.count : rows.made;
      this.problem.value = null;
    } catch (error) {
      if (!this.isClosed) this.problem.value = (error as Error).message;
    } finally {
      this.isAsking = false;
    }
  }
}
