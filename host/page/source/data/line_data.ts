// The points of lines in a time range: all rows, or the smallest and the largest value of each of as many blocks as fit the
// screen, so that no peak is lost.
import { noValue } from '../wire/messages.js';
import type { Line } from '../state/signal_selection.js';
import type { TelemetryHistory } from './telemetry_history.js';

export interface LineData {
  times: number[]; // ticks, ascending
  values: (number | null)[][]; // values of each line, in its unit; null: no value
}

// Rows of each block. Blocks begin at multiples, so that a running window does not flicker.
function blockSize(rows: number, mostBlocks: number): number {
  let size = 1;
  while (rows / size > mostBlocks) {
    size *= 2;
  }
  return size;
}

export function lineData(history: TelemetryHistory, lines: readonly Line[], from: number, to: number, columns: number): LineData {
  // The range has one more row at each end, so that lines reach the edges.
  const first = Math.max(history.first, history.rowAtTick(from) - 1);
  const end = Math.min(history.end, history.rowAtTick(to) + 1);
  const size = blockSize(end - first, Math.max(1, columns));
  return size <= 2 ? everyRow(history, lines, first, end) : blocks(history, lines, first, end, size);
}

function everyRow(history: TelemetryHistory, lines: readonly Line[], first: number, end: number): LineData {
  const times: number[] = [];
  for (let row = first; row < end; row += 1) {
    times.push(history.tickOf(row));
  }
  const values = lines.map(({ signal, index }) => {
    const scale = history.rings.get(signal)?.scale ?? 1;
    return times.map((_, i) => {
      const raw = history.valueAt(signal, index, first + i);
      return raw === noValue ? null : raw * scale;
    });
  });
  return { times, values };
}

function blocks(history: TelemetryHistory, lines: readonly Line[], first: number, end: number, size: number): LineData {
  const starts: number[] = [];
  for (let row = Math.ceil(first / size) * size; row + size <= end; row += size) {
    starts.push(row);
  }
  // Each block has two points: the smallest value, and the largest value half a block later.
  const times = starts.flatMap((row) => [history.tickOf(row), history.tickOf(row + size / 2)]);
  const values = lines.map(({ signal, index }) => {
    const ring = history.rings.get(signal);
    return starts.flatMap((row) => {
      const range = ring === undefined || index >= ring.count ? null : ring.pyramid.rangeOf(index, row, row + size);
      if (ring === undefined || range === null || range.maximum === noValue) {
        return [null, null];
      }
      return [range.minimum * ring.scale, range.maximum * ring.scale];
    });
  });
  return { times, values };
}
