// Markers in the time view, and a loop in which the frozen view plays round. All times are in ticks.
import { computed, signal } from '@preact/signals-core';
import type { TimeView } from './time_view.js';

export interface Marker {
  number: number; // number of the marker, ascending; never used twice
  tick: number;
  name: string;
}

export interface Loop {
  from: number | null; // null: not set yet
  to: number | null;
}

const noLoop: Loop = { from: null, to: null };
const longestName = 40; // characters

export class TimeMarks {
  readonly markers = signal<readonly Marker[]>([]); // in the order of ticks
  readonly loop = signal<Loop>(noLoop);
  // The range of the loop, when it has both ends.
  readonly range = computed(() => {
    const { from, to } = this.loop.value;
    return from === null || to === null ? null : { from, to };
  });
  private readonly plays = signal(false);
  readonly isPlaying = computed(() => this.plays.value && this.range.value !== null && !this.time.isLive.value);
  private lastNumber = 0;
  private position = 0; // position in the loop in ticks, with a fraction

  constructor(private readonly time: TimeView) {}

  // Sets a marker at the tick that is shown. A tick has one marker.
  mark(newest: number): void {
    const tick = this.time.shownTick(newest);
    if (this.markers.value.some((marker) => marker.tick === tick)) {
      return;
    }
    this.lastNumber += 1;
    const marker = { number: this.lastNumber, tick, name: `M${this.lastNumber}` };
    this.markers.value = [...this.markers.value, marker].sort((a, b) => a.tick - b.tick);
  }

  rename(number: number, name: string): void {
    const text = name.trim().slice(0, longestName);
    if (text !== '') {
      this.markers.value = this.markers.value.map((marker) => (marker.number === number ? { ...marker, name: text } : marker));
    }
  }

  remove(number: number): void {
    this.markers.value = this.markers.value.filter((marker) => marker.number !== number);
  }

  // Freezes the view with the marker in it.
  jumpTo(number: number, newest: number): void {
    const marker = this.markers.value.find((candidate) => candidate.number === number);
    if (marker !== undefined) {
      this.pause();
      this.time.showTick(marker.tick, newest);
    }
  }

  // Sets an end of the loop at the tick that is shown, in the frozen view. The other end is removed if it is on the wrong
  // side.
  setLoopStart(newest: number): void {
    const from = this.freezeAtShown(newest);
    const { to } = this.loop.value;
    this.setLoop({ from, to: to !== null && to > from ? to : null });
  }

  setLoopEnd(newest: number): void {
    const to = this.freezeAtShown(newest);
    const { from } = this.loop.value;
    this.setLoop({ from: from !== null && from < to ? from : null, to });
  }

  removeLoop(): void {
    this.setLoop(noLoop);
  }

  pause(): void {
    this.plays.value = false;
  }

  playOrPause(newest: number): void {
    if (this.range.value === null || this.isPlaying.value) {
      this.pause();
    } else {
      this.begin();
      this.time.showTick(this.position, newest);
    }
  }

  // Moves the cursor while the loop plays. `ticks`: since the last call.
  play(ticks: number, newest: number): void {
    const range = this.range.value;
    if (range === null || !this.isPlaying.value) {
      return;
    }
    const length = range.to - range.from;
    this.position = range.from + ((this.position - range.from + ticks) % length);
    this.time.showTick(Math.floor(this.position), newest);
  }

  // Removes the marks, because another run has other ticks.
  clear(): void {
    this.markers.value = [];
    this.removeLoop();
  }

  private freezeAtShown(newest: number): number {
    const tick = this.time.shownTick(newest);
    this.time.showTick(tick, newest);
    return tick;
  }

  private setLoop(loop: Loop): void {
    this.loop.value = loop;
    this.begin();
  }

  private begin(): void {
    this.position = this.range.value?.from ?? 0;
    this.plays.value = this.range.value !== null;
  }
}
