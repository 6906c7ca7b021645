import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { ForwardKinematics } from '../../../../host/page/source/geometry/forward_kinematics.js';
import { compose, invert, poseFromArray, rotationAbout, type Pose } from '../../../../host/page/source/geometry/quaternion.js';
import type { Body, Joint } from '../../../../host/page/source/wire/messages.js';
import { Random } from '../support/random.js';

// Links along y with the head at the positive end; pitch joints about x, half way between the links.
function chain(joints: number, pitch = 0.1): { joints: Joint[]; links: Body[] } {
  return {
    joints: Array.from({ length: joints }, (_, j) => ({
      name: `J${j}`,
      node: j + 1,
      lower: -90,
      upper: 90,
      anchor: [0, -pitch * (j + 0.5), 0],
      axis: [1, 0, 0],
    })),
    links: Array.from({ length: joints + 1 }, (_, i) => ({ name: `L${i}`, pose: [0, -pitch * i, 0, 1, 0, 0, 0], shapes: [] })),
  };
}

const atOrigin = poseFromArray([0, 0, 0, 1, 0, 0, 0]);

function assertClose(found: readonly number[], expected: readonly number[], tolerance = 1e-12): void {
  found.forEach((value, i) =>
    assert.ok(Math.abs(value - (expected[i] as number)) < tolerance, `found ${found.join()}, expected ${expected.join()}`),
  );
}

describe('forward kinematics', () => {
  it('puts the links where the description has them, at angles 0', () => {
    const robot = chain(4);
    const poses = new ForwardKinematics(robot).linkPoses(atOrigin, [0, 0, 0, 0]);
    poses.forEach((pose, i) => assertClose(pose.position, [0, -0.1 * i, 0]));
  });

  it('starts at the pose of the head, whatever its pose in the description', () => {
    const robot = chain(2);
    robot.links.forEach((link) => (link.pose[2] = 0.7));
    robot.joints.forEach((joint) => (joint.anchor[2] = 0.7));
    const head = poseFromArray([1, 2, 3, Math.SQRT1_2, 0, 0, Math.SQRT1_2]);
    const poses = new ForwardKinematics(robot).linkPoses(head, [0, 0]);
    assertClose((poses[0] as Pose).position, [1, 2, 3]);
    // A quarter turn about z takes -y to +x.
    assertClose((poses[1] as Pose).position, [1.1, 2, 3]);
    assertClose((poses[2] as Pose).position, [1.2, 2, 3]);
  });

  it('turns link j relative to link j + 1 by the angle of joint j', () => {
    const robot = chain(1);
    const poses = new ForwardKinematics(robot).linkPoses(atOrigin, [Math.PI / 2]);
    // The head turns by +90 degrees about x relative to the link behind. The head stands still, so that link turns by -90
    // degrees about the joint at y = -0.05: from 0.05 behind the joint to 0.05 above it.
    assertClose((poses[1] as Pose).position, [0, -0.05, 0.05]);
  });

  it('gives back each angle between the poses of neighbours (seed 99)', () => {
    const random = new Random(99);
    const robot = chain(60);
    robot.joints.forEach((joint) => (joint.axis = [random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)]));
    const angles = robot.joints.map(() => random.between(-1.5, 1.5));
    const displacements = new ForwardKinematics(robot).displacements(atOrigin, angles);
    robot.joints.forEach((joint, j) => {
      const relative = compose(invert(displacements[j + 1] as Pose), displacements[j] as Pose);
      const expected = rotationAbout(joint.anchor, joint.axis, angles[j] as number);
      assertClose(relative.position, expected.position, 1e-9);
      assertClose(relative.orientation, expected.orientation, 1e-9);
    });
  });

  it('keeps the two links of a joint together at its anchor (seed 7)', () => {
    const random = new Random(7);
    const robot = chain(20);
    const angles = robot.joints.map(() => random.between(-1.5, 1.5));
    const displacements = new ForwardKinematics(robot).displacements(atOrigin, angles);
    robot.joints.forEach((joint, j) => {
      const point: Pose = { position: joint.anchor, orientation: [1, 0, 0, 0] };
      assertClose(compose(displacements[j] as Pose, point).position, compose(displacements[j + 1] as Pose, point).position);
    });
  });

  it('rejects a robot whose links and joints do not fit', () => {
    const robot = chain(3);
    robot.links.pop();
    assert.throws(() => new ForwardKinematics(robot), /found 3 links and 3 joints/);
  });
});
