// Outlines of shapes in a drawing: what a person sees of them along an axis of the world.
import type { PoseArray, Shape } from '../wire/messages.js';
import { compose, poseFromArray, type Pose, type Vector } from './quaternion.js';

export type Point = readonly [number, number];

// From above: x to the right, y up. From the side: y to the right, z up.
export type Plane = 'top' | 'side';

const axesOf: Record<Plane, readonly [0 | 1 | 2, 0 | 1 | 2]> = { top: [0, 1], side: [1, 2] };
const circlePoints = 24;

export function flat(plane: Plane, point: Vector): Point {
  const [right, up] = axesOf[plane];
  return [point[right], point[up]];
}

// The point of the world that differs from another one only in the plane.
export function lifted(plane: Plane, point: Point, from: Vector): Vector {
  const [right, up] = axesOf[plane];
  const moved: [number, number, number] = [...from];
  moved[right] = point[0];
  moved[up] = point[1];
  return moved;
}

// The corners of the convex hull, counter-clockwise (A. M. Andrew, 1979).
export function convexHull(points: readonly Point[]): Point[] {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const turn = (a: Point, b: Point, c: Point) => (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  const chain = (all: readonly Point[]) => {
    const hull: Point[] = [];
    for (const point of all) {
      while (hull.length > 1 && turn(hull[hull.length - 2] as Point, hull[hull.length - 1] as Point, point) <= 0) hull.pop();
      hull.push(point);
    }
    return hull.slice(0, -1);
  };
  return sorted.length < 3 ? sorted : [...chain(sorted), ...chain(sorted.reverse())];
}

// Points on a shape, in its frame, whose hull is that of the shape, or near it where it is round.
function pointsOf({ kind, size }: Shape): Vector[] {
  const [a, b, c] = size;
  if (kind === 'box' || kind === 'mesh') {
    return [-a, a].flatMap((x) => [-b, b].flatMap((y) => [-c, c].map((z): Vector => [x, y, z])));
  }
  const angles = Array.from({ length: circlePoints }, (_, i) => (2 * Math.PI * i) / circlePoints);
  if (kind === 'cylinder') {
    return angles.flatMap((angle) => [-b, b].map((y): Vector => [a * Math.cos(angle), y, a * Math.sin(angle)]));
  }
  return angles.flatMap((angle): Vector[] => [
    [a * Math.cos(angle), a * Math.sin(angle), 0],
    [a * Math.cos(angle), 0, a * Math.sin(angle)],
    [0, a * Math.cos(angle), a * Math.sin(angle)],
  ]);
}

// The outline of a shape of a body with this pose, in metres.
export function outline(plane: Plane, body: Pose, shape: Shape): Point[] {
  const pose = compose(body, poseFromArray(shape.pose));
  return convexHull(
    pointsOf(shape).map((point) => flat(plane, compose(pose, { position: point, orientation: [1, 0, 0, 0] }).position)),
  );
}

export function arrayOf({ position, orientation }: Pose): PoseArray {
  return [...position, ...orientation];
}

// The turn of a frame about the vertical, in degrees to the left.
export function headingOf({ orientation: [w, x, y, z] }: Pose): number {
  return (Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)) * 180) / Math.PI;
}
