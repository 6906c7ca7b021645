// The space-time strip as an image: a column for each step of time, a row for each joint.
import { noValue } from '../wire/messages.js';
import type { TelemetryHistory } from './telemetry_history.js';

// Colours of a scale from the smallest to the largest value, as RGBA words of an ImageData.
export type ColourScale = Uint32Array;

// A scale between three colours 0xRRGGBB: below, zero, above. Colour-blind people can distinguish blue and orange, too.
export function divergingScale(low: number, middle: number, high: number, steps = 256): ColourScale {
  const channel = (colour: number, shift: number) => (colour >> shift) & 255;
  return Uint32Array.from({ length: steps }, (_, i) => {
    const at = (2 * i) / (steps - 1) - 1;
    const end = at < 0 ? low : high;
    const mix = (shift: number) => {
      const start = channel(middle, shift);
      return Math.round(start + (channel(end, shift) - start) * Math.abs(at));
    };
    return ((255 << 24) | (mix(0) << 16) | (mix(8) << 8) | mix(16)) >>> 0;
  });
}

export interface StripTarget {
  pixels: Uint32Array; // columns * rows, transparent where there is no value
  columns: number;
  rows: number;
}

// The largest absolute raw value of the signal in the range; 0 without values.
export function largestMagnitude(history: TelemetryHistory, signal: string, from: number, to: number): number {
  const ring = history.rings.get(signal);
  const first = history.rowAtTick(from);
  const end = history.rowAtTick(to + 1);
  let largest = 0;
  for (let index = 0; ring !== undefined && index < ring.count; index += 1) {
    const { minimum, maximum } = ring.pyramid.rangeOf(index, first, end);
    if (maximum !== noValue) {
      largest = Math.max(largest, Math.abs(minimum), Math.abs(maximum));
    }
  }
  return largest;
}

// Fills the image with the ticks `from` up to `to`; a column shows its last value. `limit`: the raw value of the scale's end.
export function fillStrip(
  target: StripTarget,
  history: TelemetryHistory,
  signal: string,
  from: number,
  to: number,
  limit: number,
  scale: ColourScale,
): void {
  const { pixels, columns, rows } = target;
  pixels.fill(0);
  const ring = history.rings.get(signal);
  if (ring === undefined || to <= from) {
    return;
  }
  const ticksPerColumn = (to - from) / columns;
  const half = (scale.length - 1) / 2;
  const factor = limit > 0 ? half / limit : 0;
  const end = history.rowAtTick(to + 1);
  for (let row = history.rowAtTick(from); row < end; row += 1) {
    const begin = Math.floor((history.tickOf(row) - from) / ticksPerColumn);
    const next = row + 1 < end ? Math.floor((history.tickOf(row + 1) - from) / ticksPerColumn) : begin + 1;
    // A row that another one overwrites in the same column need not be drawn.
    if (next === begin && row + 1 < end) {
      continue;
    }
    // Rows that are some ticks apart fill the columns between them, but not a gap in the data.
    const width = Math.max(1, Math.min(next - begin, Math.ceil(history.stride / ticksPerColumn) + 1));
    const source = (row % history.capacity) * ring.count;
    for (let joint = 0; joint < rows && joint < ring.count; joint += 1) {
      const raw = ring.values[source + joint] as number;
      if (raw !== noValue) {
        const step = Math.max(0, Math.min(scale.length - 1, Math.round(half + raw * factor)));
        const colour = scale[step] as number;
        const last = joint * columns + Math.min(columns, begin + width);
        // fill() is not used: most runs are one pixel, and a call is more expensive than that.
        for (let at = joint * columns + Math.max(0, begin); at < last; at += 1) {
          pixels[at] = colour;
        }
      }
    }
  }
}
