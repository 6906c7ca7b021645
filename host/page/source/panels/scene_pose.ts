// The pose of the robot at a tick, from the telemetry.
import type { TelemetryHistory } from '../data/telemetry_history.js';
import type { ScenePose } from '../scene/scene_messages.js';
import { noValue } from '../wire/messages.js';

const headValues = 7;
const quaternionUnit = 2 ** 30;
const micrometre = 1e-6;
const degree = Math.PI / 180;

// x, y, z in metres, then the quaternion; null if the row has none.
function headAt(history: TelemetryHistory, row: number): Float64Array | null {
  const head = new Float64Array(headValues);
  for (let i = 0; i < headValues; i += 1) {
    const raw = history.valueAt('head', i, row);
    if (raw === noValue) {
      return null;
    }
    head[i] = i < 3 ? raw * micrometre : raw / quaternionUnit;
  }
  return head;
}

// The heads of all rows one behind the other.
export function wholePathOf(history: TelemetryHistory): Float64Array {
  const path: number[] = [];
  for (let row = history.first; row < history.end; row += 1) {
    path.push(...(headAt(history, row) ?? []));
  }
  return Float64Array.from(path);
}

// Null if the row has no pose of the head.
export function poseAt(history: TelemetryHistory, tick: number, isLive: boolean): ScenePose | null {
  const row = Math.min(history.end - 1, history.rowAtTick(tick));
  const head = headAt(history, row);
  if (head === null) {
    return null;
  }
  const angle = history.rings.get('angle');
  const angles = Float32Array.from({ length: angle?.count ?? 0 }, (_, i) => {
    const raw = history.valueAt('angle', i, row);
    return raw === noValue ? 0 : raw * (angle?.scale ?? 0) * degree;
  });
  const contacts = Int32Array.from({ length: history.rings.get('contact')?.count ?? 0 }, (_, i) => {
    const raw = history.valueAt('contact', i, row);
    return raw === noValue ? 0 : raw;
  });
  return { angles, head, contacts, run: history.run, isLive };
}
