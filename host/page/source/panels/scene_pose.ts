// The pose of the robot at a tick, from the telemetry; or the pose into which a hand has moved it since the last tick.
import { poseFromArray } from '../geometry/quaternion.js';
import type { RobotView } from '../view/robot_view.js';
import { placedHead } from '../state/move_tool.js';
import type { TelemetryHistory } from '../data/telemetry_history.js';
import type { ScenePose } from '../scene/scene_messages.js';
import { noValue, type Mark } from '../wire/messages.js';

const headValues = 7;
const quaternionUnit = 2 ** 30;
const micrometre = 1e-6;
const degree = Math.PI / 180;

// The pose for the 3D view. `withGhost`: includes the simulation beside a robot on a bus, if there is one. Null if nothing
// is known.
export function shownPose(app: RobotView, tick: number, withGhost: boolean): ScenePose | null {
  const { rowsAtCursor: history, time, mover } = app;
  const isLive = time.isLive.peek() && time.cursor.peek() === null;
  const session = mover?.session.peek() ?? null;
  const head = session?.head;
  const isPresent = isLive && session !== null && (history.end === 0 || history.lastTick() < session.tick);
  const known = history.end === 0 ? null : poseAt(history, tick, isLive, withGhost);
  const lastMove = session?.last_move ?? null;
  if (known !== null && lastMove !== null && tick >= lastMove) known.lastMove = lastMove;
  const place = mover?.preview.peek() ?? null;
  if (head === undefined || !isPresent || (known !== null && session?.moved !== true && place === null)) {
    return known;
  }
  const present = poseFromArray(head);
  const { position, orientation } = place === null ? present : placedHead(present, place);
  const straight = { angles: new Float32Array(), ghost: null, contacts: new Int32Array(), lastMove };
  return { ...(known ?? straight), head: Float64Array.of(...position, ...orientation), run: history.run, isLive: false };
}

// The pose in a row; null if the row does not exist.
export function poseAt(history: TelemetryHistory, tick: number, isLive: boolean, withGhost: boolean): ScenePose | null {
  const row = Math.min(history.end - 1, history.rowAtTick(tick));
  if (row < history.first) {
    return null;
  }
  const contacts = Int32Array.from({ length: history.rings.get('contact')?.count ?? 0 }, (_, i) => {
    const raw = history.valueAt('contact', i, row);
    return raw === noValue ? 0 : raw;
  });
  const ghost = withGhost && history.valueAt('simulated_angle', 0, row) !== noValue;
  return {
    // Joints that do not measure their angle are drawn at their set-points.
    angles: anglesAt(history, ['angle', 'setpoint'], row),
    head: headAt(history, row),
    ghost: ghost ? anglesAt(history, ['simulated_angle'], row) : null,
    objects: posesAt(history, 'object', row),
    contacts,
    run: history.run,
    isLive,
    lastMove: null,
  };
}

function headAt(history: TelemetryHistory, row: number): Float64Array | null {
  return posesAt(history, 'head', row);
}

// The poses in a row: x, y, z in metres, then the quaternion; null if the row has none.
function posesAt(history: TelemetryHistory, signal: string, row: number): Float64Array | null {
  const poses = new Float64Array(signal === 'head' ? headValues : (history.rings.get(signal)?.count ?? 0));
  for (let i = 0; i < poses.length; i += 1) {
    const raw = history.valueAt(signal, i, row);
    if (raw === noValue) {
      return null;
    }
    poses[i] = i % headValues < 3 ? raw * micrometre : raw / quaternionUnit;
  }
  return poses.length === 0 ? null : poses;
}

const cut: readonly number[] = new Array<number>(headValues).fill(NaN);

// The heads of all rows one behind the other. Where a hand moved the robot between two rows there is a cut: no numbers.
export function wholePathOf(history: TelemetryHistory, marks: readonly Mark[]): Float64Array {
  const moves = marks.filter(({ kind }) => kind === 'move').map(({ tick }) => tick);
  const path: number[] = [];
  let last = -Infinity;
  for (let row = history.first; row < history.end; row += 1) {
    const tick = history.tickOf(row);
    if (moves.some((move) => move > last && move <= tick)) path.push(...cut);
    path.push(...(headAt(history, row) ?? []));
    last = tick;
  }
  return Float64Array.from(path);
}

// The angle of a joint in radians, from the first signal that has a value for the joint, else 0.
function anglesAt(history: TelemetryHistory, signals: readonly string[], row: number): Float32Array {
  return Float32Array.from({ length: history.rings.get(signals[0] as string)?.count ?? 0 }, (_, joint) => {
    const signal = signals.find((name) => history.valueAt(name, joint, row) !== noValue);
    return signal === undefined ? 0 : history.valueAt(signal, joint, row) * (history.rings.get(signal)?.scale ?? 0) * degree;
  });
}
