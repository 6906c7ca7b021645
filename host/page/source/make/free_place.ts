// Where a new object finds room on the way of a robot.
import type { Point } from '../geometry/outline.js';

const least = 0.3; // metres from the head
const gap = 0.1; // metres between two objects
const halfWidth = 0.25; // metres to each side of the way

// The distance in metres from the head to a new object in front of it: the least that does not put it into another one.
// heading: in radians, counter-clockwise from x. outlines: of the objects, from above. What begins at the robot or behind it
// is ground, or no obstacle.
export function freeDistance(head: Point, heading: number, outlines: readonly (readonly Point[])[]): number {
  const ahead = [Math.cos(heading), Math.sin(heading)] as const;
  const ranges = outlines
    .map((points) => {
      const alongs = points.map(([x, y]) => (x - head[0]) * ahead[0] + (y - head[1]) * ahead[1]);
      const acrosses = points.map(([x, y]) => (y - head[1]) * ahead[0] - (x - head[0]) * ahead[1]);
      return { from: Math.min(...alongs), to: Math.max(...alongs), right: Math.min(...acrosses), left: Math.max(...acrosses) };
    })
    .filter(({ from, right, left }) => from > 0 && right < halfWidth && left > -halfWidth)
    .sort((a, b) => a.from - b.from);
  let distance = least;
  for (const { from, to } of ranges) {
    if (from < distance + gap && to > distance - gap) distance = Math.ceil((to + gap) * 100 - 1e-6) / 100;
  }
  return distance;
}
