// Reads the rows of the part of a recording that strip and plots show. It requests more when the part leaves the present
// rows, with one request at a time.
import { pyramidBlock } from '../data/min_max_pyramid.js';
import { TelemetryHistory } from '../data/telemetry_history.js';
import type { TickRange } from '../state/time_view.js';
import type { Signal } from '../wire/messages.js';
import type { RecordedRows } from '../wire/recorded_rows.js';
import { rowLayout } from '../wire/subscription.js';
import { mostPoints, strideFor } from './recording_client.js';

export type AskRows = (signals: readonly Signal[], from: number, to: number) => Promise<RecordedRows>;

interface Loaded {
  names: string;
  from: number;
  to: number; // the last tick that was read
  askedTo: number;
  stride: number; // stride that was requested
  at: number; // milliseconds
}

const retryPeriod = 300; // milliseconds: for ticks that are not there yet
const margin = 0.25; // share of the range that is added on both sides

// The history has two rows for each block.
const capacity = Math.ceil((2 * mostPoints) / pyramidBlock) * pyramidBlock;

export class RangeRows {
  // Rows for lines: the minima of blocks, and their maxima half a block later.
  readonly lines = new TelemetryHistory(capacity);
  // The first row of each block.
  readonly samples = new TelemetryHistory(capacity);
  private loaded: Loaded | null = null;
  private isAsking = false;
  private run = 0;

  constructor(
    private readonly ask: AskRows,
    private readonly now: () => number,
    private readonly failed: (reason: string) => void,
  ) {}

  // To be called at each frame: requests only missing rows. `first`, `last`: ticks of the recording.
  want(range: TickRange, signals: readonly Signal[], first: number, last: number): void {
    const from = Math.max(first, Math.floor(range.from));
    const to = Math.min(last, Math.ceil(range.to));
    if (this.isAsking || signals.length === 0 || from > to || this.has(from, to, signals)) {
      return;
    }
    const more = Math.ceil((to - from) * margin);
    void this.load(signals, Math.max(first, from - more), Math.min(last, to + more));
  }

  private has(from: number, to: number, signals: readonly Signal[]): boolean {
    const { loaded } = this;
    if (loaded === null || loaded.names !== namesOf(signals)) {
      return false;
    }
    const isFine = loaded.stride <= strideFor((to - from) * (1 + 2 * margin));
    const isComing = loaded.askedTo >= to && this.now() - loaded.at < retryPeriod;
    return isFine && loaded.from <= from && (loaded.to >= to || isComing);
  }

  private async load(signals: readonly Signal[], from: number, to: number): Promise<void> {
    this.isAsking = true;
    const stride = strideFor(to - from + 1);
    const loaded: Loaded = { names: namesOf(signals), from, to: from - 1, askedTo: to, stride, at: this.now() };
    try {
      const rows = await this.ask(signals, from, to);
      loaded.to = Math.min(to, rows.tick + rows.rows * rows.stride - 1);
      this.take(rows, signals);
    } catch (error) {
      this.failed((error as Error).message);
      loaded.to = Infinity; // the same request would have the same answer
    }
    loaded.at = this.now();
    this.loaded = loaded;
    this.isAsking = false;
  }

  private take(rows: RecordedRows, signals: readonly Signal[]): void {
    const layout = rowLayout(signals);
    const { width, stride, tick } = rows;
    const parts = stride === 1 ? 1 : 3;
    this.run += 1;
    for (const history of [this.lines, this.samples]) {
      history.clear();
      history.run = this.run;
    }
    const append = (history: TelemetryHistory, at: number, values: Int32Array, step: number) =>
      history.append({ subscription: 0, tick: at, rows: 1, stride: step, run: this.run, hasGap: false, width, values }, layout);
    for (let row = 0; row < rows.rows; row += 1) {
      const part = (number: number) => {
        const begin = (row * parts + number) * width;
        return rows.values.subarray(begin, begin + width);
      };
      const at = tick + row * stride;
      append(this.samples, at, part(0), stride);
      if (stride === 1) {
        append(this.lines, at, part(0), 1);
      } else {
        append(this.lines, at, part(1), stride / 2);
        append(this.lines, at + stride / 2, part(2), stride / 2);
      }
    }
  }
}

function namesOf(signals: readonly Signal[]): string {
  return signals.map((signal) => signal.name).join();
}
