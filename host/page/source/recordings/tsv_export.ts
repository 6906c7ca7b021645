// Makes a table of the values in strip and plots: a line for each tick of the part that is shown, columns separated by
// tabs.
import type { RobotDocument, Signal } from '../wire/messages.js';
import { noValue } from '../wire/messages.js';
import { valueName } from '../panels/value_names.js';
import { mostPoints } from './recording_client.js';
import type { AskRows } from './range_rows.js';

export interface TsvColumn {
  signal: Signal;
  index: number;
}

export interface TsvRequest {
  columns: readonly TsvColumn[];
  from: number;
  to: number; // last tick, included
  tickSeconds: number;
  robot: RobotDocument | null;
}

// The title of a column, like that of `proleg export`: `angle_deg.J2`.
function title({ signal, index }: TsvColumn, robot: RobotDocument | null): string {
  return `${signal.name}${signal.unit === '' ? '' : `_${signal.unit}`}.${valueName(robot, signal, index)}`;
}

// The text of a value, empty if there is none. Ten digits distinguish all int32.
function text(raw: number, scale: number): string {
  return raw === noValue ? '' : String(Number((raw * scale).toPrecision(10)));
}

// The table in pieces. `time_s` is when the values hold: at the end of the tick, as in `proleg export`.
export async function* tsvPieces(ask: AskRows, request: TsvRequest): AsyncIterable<string> {
  const { columns, robot } = request;
  const signals = [...new Set(columns.map(({ signal }) => signal))];
  const offsets = new Map<Signal, number>();
  let width = 0;
  for (const signal of signals) {
    offsets.set(signal, width);
    width += signal.count;
  }
  yield `${['tick', 'time_s', ...columns.map((column) => title(column, robot))].join('\t')}\n`;
  for (let from = request.from; from <= request.to; ) {
    const rows = await ask(signals, from, Math.min(request.to, from + mostPoints / 2 - 1));
    if (rows.rows === 0 || rows.stride !== 1 || rows.tick !== from) {
      throw new Error(`rows: found tick ${rows.tick}, expected every tick from ${from} on`);
    }
    let piece = '';
    for (let row = 0; row < rows.rows; row += 1) {
      const tick = from + row;
      const values = columns.map(({ signal, index }) =>
        text(rows.values[row * width + (offsets.get(signal) ?? 0) + index] as number, signal.scale),
      );
      piece += `${[tick, Number(((tick + 1) * request.tickSeconds).toFixed(9)), ...values].join('\t')}\n`;
    }
    yield piece;
    from += rows.rows;
  }
}
