// What the 3D view gets of a recording: poses of single ticks, and the path of the head in pieces.
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { TelemetryHistory } from '../../../../host/page/source/data/telemetry_history.js';
import { poseAt, wholePathOf } from '../../../../host/page/source/panels/scene_pose.js';
import type { Mark, Signal } from '../../../../host/page/source/wire/messages.js';
import { rowLayout } from '../../../../host/page/source/wire/subscription.js';

const head: Signal = { name: 'head', unit: '', scale: 1, count: 7, of: 'robot' };
const angle: Signal = { name: 'angle', unit: 'deg', scale: 0.5, count: 1, of: 'joint' };

// Rows some ticks apart: the head is at x = tick in micrometres, the angle is the tick in half degrees.
function recorded(stride: number, rows: number): TelemetryHistory {
  const history = new TelemetryHistory();
  const values = Int32Array.from({ length: rows * 8 }, (_, i) => (i % 8 === 0 || i % 8 === 7 ? Math.floor(i / 8) * stride : i % 8 === 3 ? 2 ** 30 : 0));
  history.append({ subscription: 0, tick: 0, rows, stride, run: 1, hasGap: false, width: 8, values }, rowLayout([head, angle]));
  return history;
}

const move = (tick: number): Mark => ({ kind: 'move', tick, text: '' });

// x of the points in micrometres; '|' is a cut.
function shape(path: Float64Array): string {
  const points = Array.from({ length: path.length / 7 }, (_, i) => path[7 * i] as number);
  return points.map((x) => (Number.isNaN(x) ? '|' : Math.round(x * 1e6))).join(' ');
}

describe('the path of a recording', () => {
  it('is cut before the tick at which a hand moved the robot', () => {
    assert.equal(shape(wholePathOf(recorded(1, 5), [])), '0 1 2 3 4');
    assert.equal(shape(wholePathOf(recorded(1, 5), [move(3)])), '0 1 2 | 3 4');
  });

  it('is cut between the rows that have the tick between them', () => {
    assert.equal(shape(wholePathOf(recorded(8, 4), [move(9), move(12), move(24)])), '0 8 | 16 | 24');
  });

  it('is not cut by other marks', () => {
    assert.equal(shape(wholePathOf(recorded(1, 3), [{ kind: 'change', tick: 1, text: '' }])), '0 1 2');
  });
});

describe('the pose at a tick', () => {
  it('has the values of that row', () => {
    const pose = poseAt(recorded(1, 5), 3, false, false);
    assert.equal(pose?.head?.[0], 3e-6);
    assert.ok(Math.abs((pose?.angles[0] ?? NaN) - (1.5 * Math.PI) / 180) < 1e-7);
    assert.equal(pose?.objects, null, 'nothing but the robot moves');
  });

  it('has the poses of objects that move, one behind the other', () => {
    const object: Signal = { name: 'object', unit: '', scale: 1, count: 14, of: 'robot' };
    const history = new TelemetryHistory();
    const values = Int32Array.from({ length: 21 }, (_, i) => (i % 7 === 3 ? 2 ** 30 : i));
    history.append({ subscription: 0, tick: 0, rows: 1, stride: 1, run: 1, hasGap: false, width: 21, values }, rowLayout([head, object]));
    const objects = poseAt(history, 0, false, false)?.objects ?? new Float64Array();
    assert.equal(objects.length, 14);
    assert.equal(objects[0], 7e-6, 'x of the first');
    assert.equal(objects[3], 1);
    assert.equal(objects[7], 14e-6, 'x of the second');
  });
});
