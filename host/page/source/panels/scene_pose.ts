// The pose of the robot at a tick, from the telemetry; or where a hand has put it since the last tick.
import { poseFromArray } from '../geometry/quaternion.js';
import type { PageApp } from '../page_app.js';
import { placedHead } from '../state/move_tool.js';
import type { TelemetryHistory } from '../data/telemetry_history.js';
import type { ScenePose } from '../scene/scene_messages.js';
import { noValue } from '../wire/messages.js';

const quaternionUnit = 2 ** 30;
const micrometre = 1e-6;
const degree = Math.PI / 180;

// What the 3D view shows. Null if nothing is known.
export function shownPose(app: PageApp, tick: number): ScenePose | null {
  const { history, time, state, mover } = app;
  const isLive = time.isLive.peek() && time.cursor.peek() === null;
  const session = state.session.peek();
  const head = session?.head;
  const isPresent = isLive && session !== null && (history.end === 0 || history.lastTick() < session.tick);
  const known = history.end === 0 ? null : poseAt(history, tick, isLive);
  if (head === undefined || !isPresent || (known !== null && session.moved !== true && mover.preview.peek() === null)) {
    return known;
  }
  const present = poseFromArray(head);
  const place = mover.preview.peek();
  const { position, orientation } = place === null ? present : placedHead(present, place);
  const straight = { angles: new Float32Array(), contacts: new Int32Array() };
  return { ...(known ?? straight), head: Float64Array.of(...position, ...orientation), run: history.run, isLive: false };
}

// Null if the row has no pose of the head.
function poseAt(history: TelemetryHistory, tick: number, isLive: boolean): ScenePose | null {
  const row = Math.min(history.end - 1, history.rowAtTick(tick));
  const head = new Float64Array(7);
  for (let i = 0; i < 7; i += 1) {
    const raw = history.valueAt('head', i, row);
    if (raw === noValue) {
      return null;
    }
    head[i] = i < 3 ? raw * micrometre : raw / quaternionUnit;
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
