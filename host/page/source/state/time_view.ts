// The time that plots, strip and 3D view show. Live, the window ends at the newest tick; detached, it stands still while data
// goes on to come in. All times are in ticks.
import { computed, signal } from '@preact/signals-core';

export interface TickRange {
  from: number;
  to: number;
}

const fewestTicks = 10;

export class TimeView {
  readonly window = signal(1000); // length when live
  readonly detached = signal<TickRange | null>(null);
  // What the pointer or the arrow keys point at; null: the newest tick, or the end of the window when detached.
  readonly cursor = signal<number | null>(null);
  readonly isLive = computed(() => this.detached.value === null);

  // The range to draw, if `newest` is the newest tick. Until a run fills the window, the window stands still at tick 0.
  range(newest: number): TickRange {
    const to = Math.max(newest, this.window.value);
    return this.detached.value ?? { from: to - this.window.value, to };
  }

  // The tick whose values are shown beside the plots and in the 3D view.
  shownTick(newest: number): number {
    return Math.min(newest, this.cursor.value ?? this.detached.value?.to ?? newest);
  }

  detach(range: TickRange): void {
    const length = Math.max(fewestTicks, range.to - range.from);
    const middle = (range.from + range.to) / 2;
    this.detached.value = { from: middle - length / 2, to: middle + length / 2 };
  }

  freeze(newest: number): void {
    this.detach(this.range(newest));
    this.cursor.value = newest;
  }

  goLive(): void {
    this.detached.value = null;
    this.cursor.value = null;
  }

  // More than 1 shows more. `around` stays where it is on the screen.
  zoom(factor: number, around: number, newest: number): void {
    const { from, to } = this.range(newest);
    this.detach({ from: around - (around - from) * factor, to: around + (to - around) * factor });
  }

  moveCursor(ticks: number, newest: number): void {
    this.showTick(this.shownTick(newest) + ticks, newest);
  }

  // Puts the cursor there in the frozen view, and moves the window if it does not have the tick.
  showTick(wanted: number, newest: number): void {
    if (this.isLive.value) {
      this.freeze(newest);
    }
    const tick = Math.max(0, Math.min(newest, wanted));
    this.cursor.value = tick;
    const { from, to } = this.range(newest);
    const shift = tick < from ? tick - from : tick > to ? tick - to : 0;
    if (shift !== 0) {
      this.detached.value = { from: from + shift, to: to + shift };
    }
  }
}
