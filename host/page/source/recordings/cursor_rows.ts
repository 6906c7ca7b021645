// Reads every tick near the time cursor, for the 3D view, the table of joints and the values beside the lines. While the
// recording plays, the next ticks are read before they are shown.
import { pyramidBlock } from '../data/min_max_pyramid.js';
import { TelemetryHistory } from '../data/telemetry_history.js';
import { drawSoon } from '../view/frame_clock.js';
import type { Signal } from '../wire/messages.js';
import { rowLayout } from '../wire/subscription.js';
import type { AskRows } from './range_rows.js';

const jump = 128; // ticks that are read around a distant tick: few, so that they come soon
const piece = 512; // ticks that are read at once while the recording plays
const ahead = 384; // distance in ticks to the end of the present rows at which more are read

export class CursorRows {
  readonly history = new TelemetryHistory(pyramidBlock);
  private names = '';
  private isAsking = false;
  private failedAt: number | null = null; // the tick that cannot be read

  constructor(
    private readonly ask: AskRows,
    private readonly failed: (reason: string) => void,
  ) {}

  has(tick: number): boolean {
    return this.history.has(tick);
  }

  // To be called at each frame: requests only missing rows.
  want(tick: number, signals: readonly Signal[], first: number, last: number, isPlaying: boolean): void {
    const names = signals.map((signal) => signal.name).join();
    if (this.isAsking || signals.length === 0 || this.failedAt === tick) {
      return;
    }
    if (names !== this.names || !this.has(tick)) {
      const start = Math.floor(tick / jump) * jump;
      void this.load(signals, names, tick, Math.max(first, start), Math.min(last, start + jump - 1), true);
    } else if (isPlaying && this.history.lastTick() < Math.min(last, tick + ahead)) {
      const from = this.history.lastTick() + 1;
      void this.load(signals, names, tick, from, Math.min(last, from + piece - 1), false);
    }
  }

  private async load(signals: readonly Signal[], names: string, tick: number, from: number, to: number, isNew: boolean): Promise<void> {
    this.isAsking = true;
    try {
      const rows = await this.ask(signals, from, to);
      if (isNew) {
        this.history.clear();
        this.history.run += 1;
        this.names = names;
      }
      const { run } = this.history;
      this.history.append({ ...rows, subscription: 0, run, hasGap: false }, rowLayout(signals));
      this.failedAt = this.has(tick) ? null : tick;
      drawSoon();
    } catch (error) {
      this.failedAt = tick;
      this.failed((error as Error).message);
    }
    this.isAsking = false;
  }
}
