import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { convexHull, flat, headingOf, lifted, outline, type Point } from '../../../../host/page/source/geometry/outline.js';
import { fromAxisAngle, type Pose, type Vector } from '../../../../host/page/source/geometry/quaternion.js';

const at = (position: Vector, degrees = 0): Pose => ({ position, orientation: fromAxisAngle([0, 0, 1], (degrees * Math.PI) / 180) });
const still = [0, 0, 0, 1, 0, 0, 0] as [number, number, number, number, number, number, number];

// The area inside corners in counter-clockwise order (shoelace formula).
function area(points: readonly Point[]): number {
  return points.reduce((sum, [x, y], i) => {
    const [nextX, nextY] = points[(i + 1) % points.length] as Point;
    return sum + (x * nextY - nextX * y) / 2;
  }, 0);
}

describe('outlines', () => {
  it('of a box are its sides, from above and from the side', () => {
    const box = { kind: 'box' as const, pose: still, size: [1, 2, 3] as [number, number, number] };
    assert.ok(Math.abs(area(outline('top', at([5, 6, 7]), box)) - 8) < 1e-9);
    assert.ok(Math.abs(area(outline('side', at([5, 6, 7]), box)) - 24) < 1e-9);
    assert.ok(Math.abs(area(outline('top', at([5, 6, 7], 30), box)) - 8) < 1e-9, 'a turn changes no area');
  });

  it('of a turned box seen from the side are as wide as its diagonal', () => {
    const box = { kind: 'box' as const, pose: still, size: [1, 1, 0.5] as [number, number, number] };
    assert.ok(Math.abs(area(outline('side', at([0, 0, 0], 45), box)) - 2 * Math.SQRT2) < 1e-9);
  });

  it('of round shapes are as large as they are', () => {
    const sphere = { kind: 'sphere' as const, pose: still, size: [2, 0, 0] as [number, number, number] };
    assert.ok(Math.abs(area(outline('top', at([0, 0, 0]), sphere)) / (4 * Math.PI) - 1) < 0.02);
    const cylinder = { kind: 'cylinder' as const, pose: still, size: [0.5, 2, 0] as [number, number, number] };
    assert.ok(Math.abs(area(outline('top', at([0, 0, 0]), cylinder)) - 4) < 0.02, 'its axis is y');
  });

  it('are convex for any points', () => {
    let seed = 7;
    const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;
    for (let i = 0; i < 50; i += 1) {
      const points = Array.from({ length: 3 + Math.floor(20 * random()) }, (): Point => [random(), random()]);
      const hull = convexHull(points);
      for (const point of points) {
        hull.forEach((corner, k) => {
          const next = hull[(k + 1) % hull.length] as Point;
          const turn = (next[0] - corner[0]) * (point[1] - corner[1]) - (next[1] - corner[1]) * (point[0] - corner[0]);
          assert.ok(turn > -1e-12);
        });
      }
    }
  });

  it('have a point of the world for each point of the drawing', () => {
    assert.deepEqual(flat('side', [1, 2, 3]), [2, 3]);
    assert.deepEqual(lifted('side', [8, 9], [1, 2, 3]), [1, 8, 9]);
    assert.deepEqual(lifted('top', [8, 9], [1, 2, 3]), [8, 9, 3]);
    assert.ok(Math.abs(headingOf(at([0, 0, 0], -120)) + 120) < 1e-9);
  });
});
