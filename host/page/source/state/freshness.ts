// The age of the data that the page shows. A robot sends telemetry all the time; silence must not look like a robot at
// rest.
import { signal } from '@preact/signals-core';

const oldAfter = 2000; // milliseconds

export class Freshness {
  // Whole seconds since the last data; null: they are new, or there have been none.
  readonly age = signal<number | null>(null);
  private last: number | null = null;

  // Notes that data were received. `now`: milliseconds of a steady clock.
  note(now: number): void {
    this.last = now;
    this.age.value = null;
  }

  check(now: number): void {
    const ms = this.last === null ? 0 : now - this.last;
    this.age.value = ms > oldAfter ? Math.floor(ms / 1000) : null;
  }
}
