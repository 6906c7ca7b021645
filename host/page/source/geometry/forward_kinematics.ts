// Poses of all links of a chain from the head's pose and the joint angles.
//
// Let D(i) be the motion of link i from where it is at angles 0 in the robot's frame to where it is in the world. The angle
// of joint j turns link j relative to link j + 1, so D(j) = D(j + 1) R(j), where R(j) turns about the joint's axis at angles
// 0. Hence D(j + 1) = D(j) R(j)^-1, starting from D(0), which the head's pose gives.
import type { Joint, RobotDocument } from '../wire/messages.js';
import { compose, invert, poseFromArray, rotationAbout, type Pose } from './quaternion.js';

export class ForwardKinematics {
  private readonly joints: readonly Joint[];
  private readonly poses: Pose[]; // poses of the links at angles 0
  private readonly inverseHead: Pose;

  constructor(robot: Pick<RobotDocument, 'joints' | 'links'>) {
    if (robot.links.length !== robot.joints.length + 1) {
      throw new Error(
        `robot: found ${robot.links.length} links and ${robot.joints.length} joints, expected one link more than joints`,
      );
    }
    this.joints = robot.joints;
    this.poses = robot.links.map((link) => poseFromArray(link.pose));
    this.inverseHead = invert(this.poses[0] as Pose);
  }

  // Computes D(i) of each link. `head` is the pose of the head link's frame in the world, the angles are in radians.
  displacements(head: Pose, angles: ArrayLike<number>): Pose[] {
    let displacement = compose(head, this.inverseHead);
    const result = [displacement];
    this.joints.forEach((joint, j) => {
      displacement = compose(displacement, rotationAbout(joint.anchor, joint.axis, -(angles[j] ?? 0)));
      result.push(displacement);
    });
    return result;
  }

  // The pose of each link's frame in the world.
  linkPoses(head: Pose, angles: ArrayLike<number>): Pose[] {
    return this.displacements(head, angles).map((displacement, i) => compose(displacement, this.poses[i] as Pose));
  }
}
