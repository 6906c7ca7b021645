// The time that plots, strip and 3D view show. Live, the window ends at the newest tick; detached, it stands still while data
// goes on to come in. All times are in ticks.
import { computed, signal, type ReadonlySignal } from '@preact/signals-core';

export interface TickRange {
  from: number;
  to: number;
}

// The time for strip, plots and 3D view, live or of a recording.
export interface ShownTime {
  readonly isLive: ReadonlySignal<boolean>;
  readonly cursor: ReadonlySignal<number | null>;
  range(newest: number): TickRange;
  shownTick(newest: number): number;
  detach(range: TickRange): void;
  zoom(factor: number, around: number, newest: number): void;
  // The functions below report that the pointer is over this tick, was pressed there, or has left.
  hover(tick: number): void;
  pick(tick: number): void;
  leave(): void;
}

const fewestTicks = 10;

// The range, or a longer one with the same middle.
export function longEnough({ from, to }: TickRange): TickRange {
  const length = Math.max(fewestTicks, to - from);
  const middle = (from + to) / 2;
  return { from: middle - length / 2, to: middle + length / 2 };
}

export function zoomed({ from, to }: TickRange, factor: number, around: number): TickRange {
  return { from: around - (around - from) * factor, to: around + (to - around) * factor };
}

// The range, moved by the smallest distance so that it contains the tick.
export function shiftedTo(tick: number, { from, to }: TickRange): TickRange {
  const shift = tick < from ? tick - from : tick > to ? tick - to : 0;
  return { from: from + shift, to: to + shift };
}

// What is said of a view that does not follow the robot. `state`: of the session.
export function frozenText(state: string | undefined): string {
  const goesOn = state === 'running' || state === 'starting' || state === 'stopping';
  return goesOn ? 'Frozen view; the robot goes on.' : 'Frozen view; the robot stands still.';
}

export class TimeView implements ShownTime {
  readonly window = signal(1000); // length of the live window
  readonly detached = signal<TickRange | null>(null);
  // The tick at the pointer or chosen by the arrow keys; null: the newest tick, or the end of the window when detached.
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
    this.detached.value = longEnough(range);
  }

  freeze(newest: number): void {
    this.detach(this.range(newest));
    this.cursor.value = newest;
  }

  goLive(): void {
    this.detached.value = null;
    this.cursor.value = null;
  }

  // Changes the length of the window; a factor above 1 shows more. `around` keeps its place on the screen.
  zoom(factor: number, around: number, newest: number): void {
    this.detach(zoomed(this.range(newest), factor, around));
  }

  hover(tick: number): void {
    this.cursor.value = Math.max(0, Math.round(tick));
  }

  pick(tick: number): void {
    this.hover(tick);
  }

  leave(): void {
    if (this.isLive.peek()) {
      this.cursor.value = null;
    }
  }

  moveCursor(ticks: number, newest: number): void {
    this.showTick(this.shownTick(newest) + ticks, newest);
  }

  // Puts the cursor to a tick in the frozen view, and moves the window if it does not contain the tick.
  showTick(wanted: number, newest: number): void {
    if (this.isLive.value) {
      this.freeze(newest);
    }
    const tick = Math.max(0, Math.min(newest, wanted));
    this.cursor.value = tick;
    this.detached.value = shiftedTo(tick, this.range(newest));
  }
}
