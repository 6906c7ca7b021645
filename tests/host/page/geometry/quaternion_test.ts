// Expected values: identities of quaternions, and Rodrigues' formula.
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import {
  compose,
  conjugate,
  fromAxisAngle,
  invert,
  multiply,
  normalise,
  rotate,
  rotationAbout,
  type Pose,
  type Quaternion,
  type Vector,
} from '../../../../host/page/source/geometry/quaternion.js';
import { Random } from '../support/random.js';

const seed = 4711;
const random = new Random(seed);
const vector = (): Vector => [random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)];
const quaternion = (): Quaternion => normalise([random.between(-1, 1), ...vector()]);
const pose = (): Pose => ({ position: vector(), orientation: quaternion() });

function assertClose(found: readonly number[], expected: readonly number[], what: string): void {
  found.forEach((value, i) => assert.ok(Math.abs(value - (expected[i] as number)) < 1e-12, `${what}: found ${found.join()}, expected ${expected.join()}`));
}

const forMany = (check: () => void) => Array.from({ length: 100 }).forEach(check);

describe(`quaternions (seed ${seed})`, () => {
  it('i j = k, j k = i, k i = j, and i i = -1', () => {
    const i: Quaternion = [0, 1, 0, 0];
    const j: Quaternion = [0, 0, 1, 0];
    const k: Quaternion = [0, 0, 0, 1];
    assertClose(multiply(i, j), k, 'ij');
    assertClose(multiply(j, k), i, 'jk');
    assertClose(multiply(k, i), j, 'ki');
    assertClose(multiply(i, i), [-1, 0, 0, 0], 'ii');
  });

  it('rotate as q v q*', () => {
    forMany(() => {
      const q = quaternion();
      const v = vector();
      const product = multiply(multiply(q, [0, ...v]), conjugate(q));
      assertClose(rotate(q, v), product.slice(1), 'q v q*');
    });
  });

  it("rotate as Rodrigues' formula says", () => {
    forMany(() => {
      const axis = vector();
      const length = Math.hypot(...axis);
      const [x, y, z] = axis.map((value) => value / length) as [number, number, number];
      const angle = random.between(-Math.PI, Math.PI);
      const v = vector();
      const dot = x * v[0] + y * v[1] + z * v[2];
      const cross = [y * v[2] - z * v[1], z * v[0] - x * v[2], x * v[1] - y * v[0]];
      const expected = v.map(
        (value, n) => value * Math.cos(angle) + (cross[n] as number) * Math.sin(angle) + ([x, y, z][n] as number) * dot * (1 - Math.cos(angle)),
      );
      assertClose(rotate(fromAxisAngle(axis, angle), v), expected, 'rotated');
    });
  });

  it('compose so that a pose and its inverse give nothing', () => {
    forMany(() => {
      const a = pose();
      const { position, orientation } = compose(a, invert(a));
      assertClose(position, [0, 0, 0], 'position');
      assertClose(orientation, [1, 0, 0, 0], 'orientation');
    });
  });

  it('compose associatively', () => {
    forMany(() => {
      const [a, b, c] = [pose(), pose(), pose()];
      const left = compose(compose(a, b), c);
      const right = compose(a, compose(b, c));
      assertClose(left.position, right.position, 'position');
      assertClose(left.orientation, right.orientation, 'orientation');
    });
  });

  it('turn about a line without moving its points', () => {
    forMany(() => {
      const anchor = vector();
      const axis = vector();
      const turn = rotationAbout(anchor, axis, random.between(-3, 3));
      const point: Vector = [anchor[0] + 2 * axis[0], anchor[1] + 2 * axis[1], anchor[2] + 2 * axis[2]];
      assertClose(compose(turn, { position: point, orientation: [1, 0, 0, 0] }).position, point, 'point of the axis');
    });
  });
});
