// What a drawing of the world shows: the part around the robot and all objects that are no ground, or one that a person chose.
import { ForwardKinematics } from '../geometry/forward_kinematics.js';
import { outline, type Plane, type Point } from '../geometry/outline.js';
import { poseFromArray, type Pose } from '../geometry/quaternion.js';
import type { DraftDocument, RobotDocument } from '../wire/messages.js';
import { bodyOf, groundSize } from './make_app.js';

export interface View {
  centre: Point; // metres
  scale: number; // pixels in a metre
}

// Pixels in a metre.
export const smallestScale = 0.01;
export const largestScale = 5000;
const closestFit = 600;
const emptyScale = 150; // without anything to show
const margins: Record<Plane, number> = { top: 0.8, side: 0.5 }; // metres

function range(points: readonly Point[], axis: 0 | 1): readonly [number, number] {
  return points.reduce(([low, high], point) => [Math.min(low, point[axis]), Math.max(high, point[axis])] as const, [Infinity, -Infinity] as const);
}

export function isGround(points: readonly Point[]): boolean {
  return ([0, 1] as const).some((axis) => range(points, axis)[1] - range(points, axis)[0] > groundSize);
}

// The outlines of the robot at its start and of all objects that are no ground.
export function seenPoints(plane: Plane, draft: DraftDocument | null, robot: RobotDocument | null): Point[] {
  if (draft === null || robot === null) return [];
  const head = poseFromArray(draft.head);
  const poses = new ForwardKinematics(robot).linkPoses(head, []);
  const ofRobot = robot.links.flatMap(({ shapes }, link) => shapes.flatMap((shape) => outline(plane, poses[link] as Pose, shape)));
  const ofObjects = draft.world.objects.flatMap((object) => {
    const pose = poseFromArray(object.pose);
    const points = bodyOf(robot, object)?.shapes.flatMap((shape) => outline(plane, pose, shape)) ?? [];
    return isGround(points) ? [] : points;
  });
  return [...ofRobot, ...ofObjects];
}

// `size`: of the drawing in pixels; null: not known yet.
export function fittedView(plane: Plane, size: Point | null, points: readonly Point[]): View {
  if (points.length === 0 || size === null) return { centre: [0, 0], scale: emptyScale };
  const [[left, right], [low, high]] = [range(points, 0), range(points, 1)];
  const margin = 2 * margins[plane];
  const scale = Math.min(closestFit, size[0] / (right - left + margin), size[1] / (high - low + margin));
  return { centre: [(left + right) / 2, (low + high) / 2], scale: Math.max(smallestScale, scale) };
}

// Whether the view has a part of the rectangle around these points. True without any points.
export function showsAny({ centre, scale }: View, size: Point, points: readonly Point[]): boolean {
  if (points.length === 0) return true;
  return ([0, 1] as const).every((axis) => {
    const [low, high] = range(points, axis);
    const half = size[axis] / scale / 2;
    return low <= centre[axis] + half && high >= centre[axis] - half;
  });
}
