import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { decodeMotion, MotionPair } from '../../../../../host/page/source/make/search/motion.js';
import { poseAt } from '../../../../../host/page/source/panels/scene_pose.js';
import type { RobotDocument } from '../../../../../host/page/source/wire/messages.js';
import { motionBytes } from '../../support/motion_bytes.js';

const second = 1e6; // microseconds

describe('a motion', () => {
  it('has the angles and the head in each row, at the times of its ticks', () => {
    const motion = decodeMotion(motionBytes({ stride: 100, rows: 4 }));
    assert.deepEqual([motion.joints, motion.end], [5, 3 * second]);
    const pose = poseAt(motion.rows, 2 * second, false, false);
    assert.ok(Math.abs((pose?.angles[4] ?? 0) - Math.PI / 6) < 1e-6);
    assert.deepEqual([...(pose?.head ?? [])], [0, 2, 0.026, 1, 0, 0, 0]);
    assert.deepEqual([...motion.path].filter((_, i) => i % 7 === 1), [0, 1, 2, 3], 'the path of the head');
  });

  it('of half a minute with each tick is kept as it is', () => {
    const motion = decodeMotion(motionBytes({ rows: 3001 }));
    assert.equal(motion.end, 30 * second);
    assert.equal(motion.rows.end, 3001);
  });

  it('that is cut is refused, with what was found and what was expected', () => {
    const bytes = motionBytes();
    assert.throws(() => decodeMotion(bytes.slice(0, 20)), /found 4 bytes, expected a header of 16 bytes/);
    assert.throws(() => decodeMotion(bytes.slice(0, -4)), /found 188 bytes, expected 4 rows of 5 joints and the head/);
    assert.throws(() => decodeMotion(motionBytes({ rows: 0 })), /expected 0 rows .* at least one/);
  });
});

describe('the draft and a candidate', () => {
  const robot = {} as RobotDocument;
  const pairOf = (draftRows = 4, candidateRows = 4, tick = 10_000) =>
    new MotionPair(decodeMotion(motionBytes({ rows: draftRows, stride: 100 })), decodeMotion(motionBytes({ rows: candidateRows, stride: 100, tick, angle: 10 })), robot, 0, true);

  it('play together, round and round', () => {
    const pair = pairOf();
    pair.advance(1200);
    assert.ok(Math.abs(pair.seconds - 1.2) < 1e-9);
    pair.advance(2000);
    assert.equal(pair.seconds, 0);
    assert.equal(pair.time.isPlaying.value, true);
    pair.advance(500);
    assert.ok(Math.abs(pair.seconds - 0.5) < 1e-9);
  });

  it('stand still while they are paused, at any time', () => {
    const pair = pairOf();
    pair.time.isPlaying.value = false;
    pair.seekSeconds(1.5);
    pair.advance(1000);
    assert.equal(pair.seconds, 1.5);
  });

  it('are at the same second, also with ticks of other lengths; the shorter one is not shown behind its end', () => {
    const pair = pairOf(4, 4, 5_000);
    assert.equal(pair.duration, 3);
    const { has, rowsAtCursor } = pair.compared.reader;
    assert.deepEqual(poseAt(rowsAtCursor, second, false, false)?.head?.[1], 2, 'it takes half the time for its way');
    assert.deepEqual([has(1.4 * second), has(2 * second)], [true, false]);
  });

  it('are another run than any before, so that the view draws them', () => {
    const runs = [pairOf(), pairOf()].flatMap(({ draft, candidate }) => [draft.rows.run, candidate.rows.run]);
    assert.equal(new Set(runs).size, 4);
  });
});
