// The pose of the robot at a tick, from the telemetry.
import type { TelemetryHistory } from '../data/telemetry_history.js';
import type { ScenePose } from '../scene/scene_messages.js';
import { noValue } from '../wire/messages.js';

const quaternionUnit = 2 ** 30;
const micrometre = 1e-6;
const degree = Math.PI / 180;

// Null if the row is not there. `withGhost`: with the simulation beside a robot on a bus, if there is one.
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
    contacts,
    run: history.run,
    isLive,
  };
}

function headAt(history: TelemetryHistory, row: number): Float64Array | null {
  const head = new Float64Array(7);
  for (let i = 0; i < 7; i += 1) {
    const raw = history.valueAt('head', i, row);
    if (raw === noValue) {
      return null;
    }
    head[i] = i < 3 ? raw * micrometre : raw / quaternionUnit;
  }
  return head;
}

// Radians; of the first signal that has a value for the joint, else 0.
function anglesAt(history: TelemetryHistory, signals: readonly string[], row: number): Float32Array {
  return Float32Array.from({ length: history.rings.get(signals[0] as string)?.count ?? 0 }, (_, joint) => {
    const signal = signals.find((name) => history.valueAt(name, joint, row) !== noValue);
    return signal === undefined ? 0 : history.valueAt(signal, joint, row) * (history.rings.get(signal)?.scale ?? 0) * degree;
  });
}
