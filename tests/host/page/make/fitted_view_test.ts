import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import type { Plane, Point } from '../../../../host/page/source/geometry/outline.js';
import { fittedView, seenPoints, showsAny, type View } from '../../../../host/page/source/make/fitted_view.js';
import type { DraftDocument, RobotDocument, WorldObject } from '../../../../host/page/source/wire/messages.js';

const upright = [1, 0, 0, 0] as const;

// A chain of boxes of 0.1 m along -x, with its head at 1, 2; objects are boxes of an edge length at a place of the axis x.
function scenario(links: number, boxes: readonly (readonly [number, number])[]) {
  const box = (edge: number) => ({ kind: 'box', size: [edge / 2, edge / 2, edge / 2], pose: [0, 0, 0, ...upright], colour: null });
  const joint = (i: number) => ({ anchor: [-0.05 - 0.1 * i, 0, 0], axis: [0, 1, 0] });
  const robot = {
    links: Array.from({ length: links }, (_, i) => ({ pose: [-0.1 * i, 0, 0, ...upright], shapes: [box(0.1)] })),
    joints: Array.from({ length: links - 1 }, (_, i) => joint(i)),
    objects: [],
    terrain: boxes.map(([edge]) => ({ shapes: [box(edge)] })),
  } as unknown as RobotDocument;
  const objects = boxes.map(([, x], index) => ({ name: `box ${index}`, moves: false, index, pose: [x, 0, 0, ...upright] }) as unknown as WorldObject);
  return { robot, draft: { head: [1, 2, 0.05, ...upright], world: { objects } } as unknown as DraftDocument };
}

function isInside(view: View, size: Point, [x, y]: Point): boolean {
  return Math.abs(x - view.centre[0]) * view.scale <= size[0] / 2 && Math.abs(y - view.centre[1]) * view.scale <= size[1] / 2;
}

describe('the first view of a drawing', () => {
  const sizes: Point[] = [[40, 30], [390, 200], [640, 290], [1920, 500]];

  it('has the robot and all objects, at every size, and no more than their surroundings', () => {
    for (const world of [scenario(2, []), scenario(9, [[0.3, 3]]), scenario(40, []), scenario(3, [[20, -300], [5, 400]])]) {
      for (const plane of ['top', 'side'] as Plane[]) {
        const points = seenPoints(plane, world.draft, world.robot);
        for (const size of sizes) {
          const view = fittedView(plane, size, points);
          assert.ok(points.every((point) => isInside(view, size, point)), `${plane} ${size}`);
          const extent = ([0, 1] as const).map((axis) => Math.max(...points.map((point) => point[axis])) - Math.min(...points.map((point) => point[axis])));
          const shown = size.map((pixels) => pixels / view.scale);
          assert.ok(shown.some((length, axis) => length < (extent[axis] as number) + 2 || view.scale === 600), `${shown} m of ${extent} m`);
        }
      }
    }
  });

  it('begins with the links of the robot, not only its head', () => {
    const { draft, robot } = scenario(40, []);
    const x = seenPoints('top', draft, robot).map((point) => point[0]);
    assert.ok(Math.abs(Math.max(...x) - 1.05) < 1e-9 && Math.abs(Math.min(...x) - (1.05 - 4)) < 1e-9, `${Math.min(...x)} to ${Math.max(...x)}`);
  });

  it('leaves the ground out', () => {
    const { draft, robot } = scenario(2, [[100, 0]]);
    assert.deepEqual(seenPoints('top', draft, robot), seenPoints('top', draft, scenario(2, []).robot));
  });

  it('is no view of a drawing of one pixel before the size and the documents are known', () => {
    const { draft, robot } = scenario(2, []);
    assert.ok(fittedView('top', null, seenPoints('top', draft, robot)).scale > 50);
    assert.ok(fittedView('top', [600, 300], seenPoints('top', draft, null)).scale > 50);
  });
});

describe('a view that a person has chosen', () => {
  it('is kept as long as a part of the scene is in it', () => {
    const view: View = { centre: [0, 0], scale: 100 };
    assert.ok(showsAny(view, [400, 200], [[1, 0], [9, 5]]));
    assert.ok(showsAny(view, [400, 200], [[-9, -9], [9, 9]]));
    assert.ok(!showsAny(view, [400, 200], [[3, 0], [9, 5]]));
    assert.ok(showsAny(view, [400, 200], []));
  });
});
