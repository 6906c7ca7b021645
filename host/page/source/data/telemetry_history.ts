// The last rows of telemetry of one run, in rings of typed arrays. Panels read it when they draw; nothing is copied.
import type { RowLayout } from '../wire/subscription.js';
import type { TelemetryMessage } from '../wire/telemetry_message.js';
import { noValue } from '../wire/messages.js';
import { MinMaxPyramid, pyramidBlock } from './min_max_pyramid.js';

// The default capacity is two minutes at 100 ticks a second.
const defaultCapacity = 3 * pyramidBlock;

export interface SignalRing {
  count: number; // values in a row
  scale: number;
  values: Int32Array; // capacity * count; row r is at (r % capacity) * count
  pyramid: MinMaxPyramid;
}

export class TelemetryHistory {
  // Rows are numbered from 0 since the run began; those from `first` up to, not including, `end` are there.
  end = 0;
  run = -1;
  stride = 1; // ticks between two rows of the last message
  readonly rings = new Map<string, SignalRing>();
  private readonly ticks: Float64Array;

  constructor(readonly capacity: number = defaultCapacity) {
    this.ticks = new Float64Array(capacity);
  }

  get first(): number {
    return Math.max(0, this.end - this.capacity);
  }

  // Forgets all rows, for another robot or another run.
  clear(): void {
    this.end = 0;
    this.rings.clear();
  }

  // Adds the rows of a message. Throws an Error if it does not fit the layout.
  append(message: TelemetryMessage, layout: RowLayout): void {
    if (message.rows > 0 && message.width !== layout.width) {
      throw new Error(`telemetry: found ${message.width} values in a row, expected ${layout.width}`);
    }
    if (message.run !== this.run || (this.end > 0 && message.tick <= this.lastTick())) {
      this.clear();
      this.run = message.run;
    }
    this.stride = Math.max(1, message.stride);
    for (const { signal } of layout.signals) {
      this.prepareRing(signal.name, signal.count, signal.scale);
    }
    if (message.hasGap && this.end > 0 && message.tick - 1 > this.lastTick()) {
      // A row without values makes a gap in lines.
      this.appendRow(message.tick - 1, null, 0, layout);
    }
    for (let row = 0; row < message.rows; row += 1) {
      this.appendRow(message.tick + row * this.stride, message.values, row * message.width, layout);
    }
  }

  tickOf(row: number): number {
    return this.ticks[row % this.capacity] as number;
  }

  lastTick(): number {
    return this.tickOf(this.end - 1);
  }

  has(tick: number): boolean {
    return this.end > 0 && tick >= this.tickOf(this.first) && tick <= this.lastTick();
  }

  // The raw value; noValue if the row or the signal does not exist.
  valueAt(signal: string, index: number, row: number): number {
    const ring = this.rings.get(signal);
    if (ring === undefined || row < this.first || row >= this.end || index >= ring.count) {
      return noValue;
    }
    return ring.values[(row % this.capacity) * ring.count + index] as number;
  }

  // The first row whose tick is at least `tick`; `end` if there is none.
  rowAtTick(tick: number): number {
    let low = this.first;
    let high = this.end;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.tickOf(middle) < tick) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return low;
  }

  private prepareRing(name: string, count: number, scale: number): void {
    const known = this.rings.get(name);
    if (known !== undefined && known.count === count && known.scale === scale) {
      return;
    }
    const values = new Int32Array(this.capacity * count).fill(noValue);
    this.rings.set(name, { count, scale, values, pyramid: new MinMaxPyramid(values, this.capacity, count) });
  }

  private appendRow(tick: number, values: Int32Array | null, start: number, layout: RowLayout): void {
    const at = this.end % this.capacity;
    this.ticks[at] = tick;
    for (const ring of this.rings.values()) {
      ring.values.fill(noValue, at * ring.count, (at + 1) * ring.count);
    }
    if (values !== null) {
      for (const { signal, offset } of layout.signals) {
        const ring = this.rings.get(signal.name) as SignalRing;
        for (let i = 0; i < ring.count; i += 1) {
          ring.values[at * ring.count + i] = values[start + offset + i] as number;
        }
      }
    }
    for (const ring of this.rings.values()) {
      ring.pyramid.append(this.end);
    }
    this.end += 1;
  }
}
