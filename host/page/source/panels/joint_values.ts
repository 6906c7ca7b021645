// Values of a joint in the history, as numbers and as text.
import type { RobotView } from '../view/robot_view.js';
import { noValue } from '../wire/messages.js';

type Rows = Pick<RobotView, 'rowsAtCursor'>;

// Whether the values at a tick of a recording are still to come. Other ticks are not drawn meanwhile.
export function areComing({ history, rowsAtCursor }: Pick<RobotView, 'history' | 'rowsAtCursor'>, tick: number): boolean {
  return rowsAtCursor !== history && !rowsAtCursor.has(tick);
}

// The value of a joint in the signal's unit; null if there is none.
export function valueOf(app: Rows, signal: string, joint: number, row: number): number | null {
  const raw = app.rowsAtCursor.valueAt(signal, joint, row);
  return raw === noValue ? null : raw * (app.rowsAtCursor.rings.get(signal)?.scale ?? 1);
}

// The value in the second recording at the tick; null also if there is no second recording.
export function comparedValueOf({ compared }: Pick<RobotView, 'compared'>, signal: string, joint: number, tick: number): number | null {
  const reader = compared?.peek()?.reader;
  return reader?.has(tick) === true ? valueOf(reader, signal, joint, reader.rowsAtCursor.rowAtTick(tick)) : null;
}

export function numberText(value: number | null, decimals: number): string {
  // The text has no sign for -0.0.
  return value === null ? '–' : value.toFixed(decimals).replace(/^-(0(\.0*)?)$/, '$1');
}

// Contacts belong to links; a joint has those of the link in front of it: rear, front.
export function contactText(app: Rows, joint: number, row: number): string {
  const bits = app.rowsAtCursor.valueAt('contact', joint, row);
  return bits === noValue ? '' : `${(bits & 1) !== 0 ? '●' : '○'} ${(bits & 2) !== 0 ? '●' : '○'}`;
}

// The angle of a joint in degrees: the commanded angle if it is held, else the present one; null if it is not known.
export function positionOf(app: Rows & Pick<RobotView, 'history' | 'poses'>, joint: number): number | null {
  const newest = app.history.end - 1;
  return (
    app.poses?.targets.peek().get(joint) ?? valueOf(app, 'setpoint', joint, newest) ?? valueOf(app, 'angle', joint, newest)
  );
}
