// Values of a joint in the history, as numbers and as text.
import type { RobotView } from '../robot_view.js';
import { noValue } from '../wire/messages.js';

type Rows = Pick<RobotView, 'rowsAtCursor'>;

// Whether the values at a tick of a recording are still to come. Nothing is drawn of other ticks meanwhile.
export function areComing({ history, rowsAtCursor }: Pick<RobotView, 'history' | 'rowsAtCursor'>, tick: number): boolean {
  return rowsAtCursor !== history && !rowsAtCursor.has(tick);
}

// In the signal's unit; null if there is none.
export function valueOf(app: Rows, signal: string, joint: number, row: number): number | null {
  const raw = app.rowsAtCursor.valueAt(signal, joint, row);
  return raw === noValue ? null : raw * (app.rowsAtCursor.rings.get(signal)?.scale ?? 1);
}

// Of the second recording at the tick; null without one, too.
export function comparedValueOf({ compared }: Pick<RobotView, 'compared'>, signal: string, joint: number, tick: number): number | null {
  const reader = compared?.peek()?.reader;
  return reader?.has(tick) === true ? valueOf(reader, signal, joint, reader.rowsAtCursor.rowAtTick(tick)) : null;
}

export function numberText(value: number | null, decimals: number): string {
  // Without the sign of -0.0.
  return value === null ? '–' : value.toFixed(decimals).replace(/^-(0(\.0*)?)$/, '$1');
}

// Contacts belong to links; a joint has those of the link in front of it: rear, front.
export function contactText(app: RobotView, joint: number, row: number): string {
  const bits = app.rowsAtCursor.valueAt('contact', joint, row);
  return bits === noValue ? '' : `${(bits & 1) !== 0 ? '●' : '○'} ${(bits & 2) !== 0 ? '●' : '○'}`;
}

// Degrees: where a held joint is told to be, else where it is; null if it is not known.
export function positionOf(app: RobotView, joint: number): number | null {
  const newest = app.history.end - 1;
  return (
    app.poses?.targets.peek().get(joint) ?? valueOf(app, 'setpoint', joint, newest) ?? valueOf(app, 'angle', joint, newest)
  );
}
