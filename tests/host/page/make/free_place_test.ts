// A new object comes in front of the robot, and not into another one.
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import type { Point } from '../../../../host/page/source/geometry/outline.js';
import { freeDistance } from '../../../../host/page/source/make/free_place.js';

const north = Math.PI / 2;
const rectangle = (left: number, right: number, near: number, far: number): Point[] => [
  [left, near],
  [right, near],
  [right, far],
  [left, far],
];

describe('room for a new object', () => {
  it('is 0.3 m in front of the head where nothing is', () => {
    assert.equal(freeDistance([2, 5], north, []), 0.3);
  });

  it('is behind what is there already, one after the other', () => {
    const stairs = [rectangle(-0.5, 0.5, 0.3, 0.6), rectangle(-0.5, 0.5, 0.6, 0.9)];
    assert.equal(freeDistance([0, 0], north, stairs), 1);
    assert.equal(freeDistance([0, 0], north, [...stairs, rectangle(-0.5, 0.5, 1, 1.5)]), 1.6);
    assert.equal(freeDistance([0, 0], north, [rectangle(-0.5, 0.5, 1, 1.5), ...stairs].reverse()), 1.6, 'in any order');
  });

  it('does not look at what is behind the robot, beside its way, or far in front of it', () => {
    assert.equal(freeDistance([0, 0], north, [rectangle(-1, 1, -2, -1)]), 0.3);
    assert.equal(freeDistance([0, 0], north, [rectangle(0.3, 1, -1, 3)]), 0.3);
    assert.equal(freeDistance([0, 0], north, [rectangle(-1, 1, 4, 5)]), 0.3);
    assert.equal(freeDistance([0, 0], north, [rectangle(-8, 8, -8, 8)]), 0.3, 'the floor');
  });

  it('turns with the robot', () => {
    assert.equal(freeDistance([0, 0], 0, [rectangle(0.2, 0.9, -0.5, 0.5)]), 1);
    assert.equal(freeDistance([0, 0], Math.PI, [rectangle(0.2, 0.9, -0.5, 0.5)]), 0.3);
  });
});
