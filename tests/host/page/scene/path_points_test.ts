// The path of the head in pieces: what is joined, what is not, and what goes when it is full.
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import type { Vector } from '../../../../host/page/source/geometry/quaternion.js';
import { PathPoints } from '../../../../host/page/source/scene/path_points.js';

const at = (x: number): Vector => [x, 0, 0];

// The x coordinates of both ends of each segment.
function segments(points: PathPoints): [number, number][] {
  const x = (point: number) => points.positions[3 * point] as number;
  const ends = [...points.segments.subarray(0, points.segmentEnds)];
  return ends.flatMap((end, i) => (i % 2 === 0 ? [[x(end), x(ends[i + 1] as number)] as [number, number]] : []));
}

describe('a path', () => {
  it('joins each point with the one before', () => {
    const points = new PathPoints(8);
    [0, 1, 2].forEach((x) => points.add(at(x), 0.5));
    assert.deepEqual(segments(points), [[0, 1], [1, 2]]);
  });

  it('leaves out points that are close to the last one', () => {
    const points = new PathPoints(8);
    assert.equal(points.add(at(0), 0.5), true);
    assert.equal(points.add(at(0.4), 0.5), false);
    assert.equal(points.add(at(0.6), 0.5), true);
    assert.equal(points.count, 2);
  });

  it('has no segment through the air where it is cut', () => {
    const points = new PathPoints(8);
    [0, 1].forEach((x) => points.add(at(x), 0.5));
    points.cut();
    [1.1, 8, 9].forEach((x) => points.add(at(x), 0.5));
    assert.deepEqual(segments(points).map((ends) => ends.map((x) => Number(x.toFixed(3)))), [[0, 1], [1.1, 8], [8, 9]]);
  });

  it('is empty after it was cleared', () => {
    const points = new PathPoints(8);
    [0, 1].forEach((x) => points.add(at(x), 0.5));
    points.clear();
    points.add(at(5), 0.5);
    assert.deepEqual(segments(points), []);
    assert.equal(points.count, 1);
  });

  it('keeps every second point and all cuts when it is full', () => {
    for (const cutAt of [1, 2, 3, 4, 5, 6, 7]) {
      const points = new PathPoints(8);
      for (let x = 0; x < 9; x += 1) {
        if (x === cutAt) points.cut();
        points.add(at(x), 0.5);
      }
      assert.equal(points.count, 5, 'four of eight, and the ninth');
      for (const [from, to] of segments(points)) {
        assert.ok(to < cutAt || from >= cutAt, `a segment from ${from} to ${to} over the cut before ${cutAt}`);
      }
      assert.ok(segments(points).length >= 2);
    }
  });
});
