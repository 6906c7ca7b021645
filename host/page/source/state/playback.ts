// The time of a recording that is played: the cursor, the speed, and the part that strip and plots show. All times are in
// ticks.
import { computed, signal } from '@preact/signals-core';
import { longEnough, shiftedTo, zoomed, type ShownTime, type TickRange } from './time_view.js';

// The speeds, as multiples of real time.
export const speeds = [0.1, 0.2, 0.5, 1, 2, 5, 10] as const;

export class Playback implements ShownTime {
  readonly isLive = signal(false);
  readonly isPlaying = signal(false);
  readonly speed = signal<number>(1);
  // The part that strip and plots show; null: the whole recording.
  readonly part = signal<TickRange | null>(null);
  readonly cursor = computed(() => Math.floor(this.position.value));
  private readonly position;
  private readonly end;

  constructor(
    readonly first: number,
    last: number,
    private readonly tickRate: number,
  ) {
    this.position = signal(first);
    this.end = signal(last);
  }

  get last(): number {
    return this.end.value;
  }

  // Notes that the recording has grown. `follows`: the time cursor moves with its end.
  extend(last: number, follows: boolean): void {
    this.end.value = Math.max(last, this.end.peek());
    if (follows) this.seek(this.last);
  }

  // Starts or stops playing; at the end it plays from the start again.
  toggle(): void {
    if (!this.isPlaying.value && this.cursor.value >= this.last) {
      this.seek(this.first);
    }
    this.isPlaying.value = !this.isPlaying.value;
  }

  // Moves the cursor while the recording plays.
  advance(milliseconds: number): void {
    if (!this.isPlaying.peek()) {
      return;
    }
    this.seek(this.position.peek() + (milliseconds / 1000) * this.tickRate * this.speed.peek());
    if (this.cursor.peek() >= this.last) {
      this.isPlaying.value = false;
    }
  }

  seek(tick: number): void {
    const position = Math.max(this.first, Math.min(this.last, tick));
    this.position.value = position;
    if (this.part.peek() !== null) {
      this.part.value = shiftedTo(position, this.part.peek() as TickRange);
    }
  }

  // Stops playing and moves the cursor, because the arrow keys are for single ticks.
  step(ticks: number): void {
    this.isPlaying.value = false;
    this.seek(this.cursor.peek() + ticks);
  }

  // Chooses the next speed of the list.
  faster(): void {
    this.speed.value = speeds.find((speed) => speed > this.speed.value) ?? this.speed.value;
  }

  slower(): void {
    this.speed.value = [...speeds].reverse().find((speed) => speed < this.speed.value) ?? this.speed.value;
  }

  range(): TickRange {
    return this.part.value ?? longEnough({ from: this.first, to: this.last });
  }

  shownTick(): number {
    return this.cursor.value;
  }

  detach(range: TickRange): void {
    const { from, to } = longEnough(range);
    const isAll = from <= this.first && to >= this.last;
    this.part.value = isAll ? null : { from, to };
  }

  zoom(factor: number, around: number): void {
    this.detach(zoomed(this.range(), factor, around));
  }

  // Does nothing: only a press moves the cursor of a recording, because it moves by itself.
  hover(): void {}

  leave(): void {}

  pick(tick: number): void {
    this.seek(Math.round(tick));
  }
}
