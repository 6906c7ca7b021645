import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { markStep, markText, RobotPicture } from '../../../../host/page/source/class/robot_picture.js';
import { poseFromArray } from '../../../../host/page/source/geometry/quaternion.js';
import type { TileRobot } from '../../../../host/page/source/class/tile_messages.js';

const chain = (axes: [number, number, number][]): TileRobot => ({
  joints: axes.map((axis, i) => ({ name: `J${i}`, node: i, lower: -90, upper: 90, anchor: [0, -0.1 * i, 0], axis })),
  links: Array.from({ length: axes.length + 1 }, (_, i) => ({ name: `L${i}`, pose: [0, -0.1 * i, 0, 1, 0, 0, 0], shapes: [] })),
  terrain: [],
});
const along = (x: number, y: number) => [poseFromArray([x, y, 0, 1, 0, 0, 0]), poseFromArray([0, 0, 0, 1, 0, 0, 0])];

describe('the small picture of a robot', () => {
  it('is from the side if the robot only pitches and goes along the picture, else from above', () => {
    const pitching = new RobotPicture(chain([[1, 0, 0], [1, 0, 0]]));
    assert.equal(pitching.planeOf(along(0, 1)), 'side');
    assert.equal(pitching.planeOf(along(0.3, -1)), 'side');
    assert.equal(pitching.planeOf(along(1, 0.2)), 'top', 'it was turned');
    assert.equal(new RobotPicture(chain([[1, 0, 0], [0, 0, 1]])).planeOf(along(0, 1)), 'top');
  });

  it('has marks at round distances', () => {
    assert.deepEqual([0.03, 0.05, 0.07, 0.2, 0.9, 1.1, 3, 7].map(markStep), [0.05, 0.05, 0.1, 0.2, 1, 2, 5, 10]);
    assert.deepEqual([0.30000000000000004, -1e-17, 12].map(markText), ['0.3 m', '0 m', '12 m']);
  });
});
