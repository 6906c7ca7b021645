import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { JointDrag, type Ray } from '../../../../host/page/source/geometry/joint_drag.js';
import { ForwardKinematics } from '../../../../host/page/source/geometry/forward_kinematics.js';
import { compose, invert, subtract, type Pose, type Vector } from '../../../../host/page/source/geometry/quaternion.js';
import type { PoseArray, RobotDocument } from '../../../../host/page/source/wire/messages.js';
import { Random } from '../support/random.js';

const eye: Vector = [0.3, -2, 0.5];
const identityPose: Pose = { position: [0, 0, 0], orientation: [1, 0, 0, 0] };

function rayTo(point: Vector, from: Vector = eye): Ray {
  const way = subtract(point, from);
  const length = Math.hypot(...way);
  return { origin: from, direction: [way[0] / length, way[1] / length, way[2] / length] };
}

const close = (found: number, expected: number) =>
  assert.ok(Math.abs(found - expected) < 1e-9, `found ${found}, expected ${expected}`);

describe('a joint that is dragged', () => {
  const anchor: Vector = [0.1, 0, 0.2];
  const axis: Vector = [0, 1, 0];
  // At the angle a about y from x, seen against the axis: (cos a, -sin a) in x and z.
  const at = (angle: number): Vector => [anchor[0] + 0.1 * Math.cos(angle), 0.03, anchor[2] - 0.1 * Math.sin(angle)];
  const begin = (angle = 0) => JointDrag.begin(rayTo(at(angle)), at(angle), anchor, axis) as JointDrag;

  it('turns by the angle that the pointer goes round the axis', () => {
    const drag = begin();
    for (const angle of [0.1, 0.7, -0.4, 1.5]) {
      close(drag.angleOf(rayTo(at(angle))), angle);
    }
  });

  it('does not depend on how far from the axis the pointer goes', () => {
    const [x, y, z] = at(0.6);
    const farther: Vector = [anchor[0] + 3 * (x - anchor[0]), y, anchor[2] + 3 * (z - anchor[2])];
    close(begin().angleOf(rayTo(farther)), 0.6);
  });

  it('counts on after half a turn', () => {
    const drag = begin();
    for (let angle = 0; angle < 4; angle += 0.2) {
      drag.angleOf(rayTo(at(angle)));
    }
    close(drag.angleOf(rayTo(at(4))), 4);
  });

  it('is not grabbed on its axis, or when its plane is seen from the side', () => {
    const onAxis: Vector = [anchor[0], 0.03, anchor[2]];
    assert.equal(JointDrag.begin(rayTo(onAxis), onAxis, anchor, axis), null);
    const side = rayTo(at(0), [at(0)[0], 0.031, 2]);
    assert.equal(JointDrag.begin(side, at(0), anchor, axis), null);
  });

  it('keeps its angle when the pointer leaves the plane', () => {
    const drag = begin();
    drag.angleOf(rayTo(at(0.5)));
    close(drag.angleOf({ origin: eye, direction: [0, -1, 0] }), 0.5);
  });

  // A point of link 0, as the kinematics that draw the robot move it relative to link 1.
  it('has the sense of the drawn joint angle', () => {
    const random = new Random(20260101);
    const still: PoseArray = [0, 0, 0, 1, 0, 0, 0];
    const robot: Pick<RobotDocument, 'joints' | 'links'> = {
      joints: [{ name: 'J1', node: 1, lower: -90, upper: 90, anchor: [0.1, 0, 0.2], axis: [0, 1, 0] }],
      links: ['head', 'tail'].map((name) => ({ name, pose: still, shapes: [] })),
    };
    const point = at(0);
    for (let i = 0; i < 100; i += 1) {
      const angle = random.between(-1.4, 1.4);
      const [head, tail] = new ForwardKinematics(robot).displacements(identityPose, [angle]) as [Pose, Pose];
      const moved = compose(compose(invert(tail), head), { position: point, orientation: [1, 0, 0, 0] });
      close(begin().angleOf(rayTo(moved.position)), angle);
    }
  });
});
