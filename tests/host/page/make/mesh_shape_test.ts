import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { rotate, type Vector } from '../../../../host/page/source/geometry/quaternion.js';
import { drawShape, projection, quarterTurns, readShape, type MeshShape } from '../../../../host/page/source/make/mesh_shape.js';

const near = (a: Vector, b: Vector) => a.every((value, i) => Math.abs(value - b[i]!) < 1e-12);

// A square of 2 x 2 around the origin, in the plane of x and z.
const square: MeshShape = {
  vertices: Float32Array.from([-1, 0, -1, 1, 0, -1, 1, 0, 1, -1, 0, 1]),
  triangles: Uint32Array.from([0, 1, 2, 0, 2, 3]),
};

function picture(width: number, height: number) {
  return { width, height, data: new Uint8ClampedArray(4 * width * height) };
}

describe('turns of 90 degrees', () => {
  it('are about x, then y, then z, as the program has them', () => {
    assert.ok(near(rotate(quarterTurns([1, 0, 0]), [0, 1, 0]), [0, 0, 1]));
    assert.ok(near(rotate(quarterTurns([0, 1, 0]), [0, 0, 1]), [1, 0, 0]));
    assert.ok(near(rotate(quarterTurns([0, 0, 1]), [1, 0, 0]), [0, 1, 0]));
    assert.ok(near(rotate(quarterTurns([1, 1, 0]), [0, 1, 0]), [1, 0, 0]));
    assert.ok(near(rotate(quarterTurns([2, 0, 3]), [1, 2, 3]), [-2, -1, -3]));
  });
});

describe('the shape of a mesh', () => {
  it('is read behind the header of an answer in bytes', () => {
    const buffer = new ArrayBuffer(16 + 8 + 12 * 3 + 12);
    const view = new DataView(buffer);
    view.setUint32(16, 3, true);
    view.setUint32(20, 1, true);
    view.setFloat32(24, 1.5, true);
    view.setUint32(24 + 36 + 8, 2, true);
    const shape = readShape(buffer, 16);
    assert.equal(shape.vertices.length, 9);
    assert.equal(shape.vertices[0], 1.5);
    assert.deepEqual([...shape.triangles], [0, 0, 2]);
  });

  it('covers the pixels that it has, whichever side is seen', () => {
    for (const turn of [quarterTurns([0, 0, 0]), quarterTurns([0, 0, 2])]) {
      const drawn = picture(20, 10);
      drawShape(drawn, square, turn, [0, 0, 0], 4, { yaw: 0, pitch: 0 }, [1, 1, 1]);
      const covered = Array.from({ length: 200 }, (_, i) => drawn.data[4 * i + 3]! > 0);
      const count = covered.filter(Boolean).length;
      assert.ok(count >= 64 && count <= 81, `${count} pixels of a square of 8 x 8`);
      assert.ok(covered[5 * 20 + 10]);
      assert.ok(!covered[0]);
    }
  });

  it('hides what is behind', () => {
    // A small square in front of a large one: the robot's right is right, and nearer means less y.
    const two: MeshShape = {
      vertices: Float32Array.from([-1, 0, -1, 1, 0, -1, 1, 0, 1, -1, -1, -1, 0, -1, -1, -1, -1, 0]),
      triangles: Uint32Array.from([0, 1, 2, 3, 4, 5]),
    };
    assert.ok(projection({ yaw: 0, pitch: 0 })([0, -1, 0])[2] > projection({ yaw: 0, pitch: 0 })([0, 0, 0])[2]);
    for (const order of [two, { ...two, triangles: Uint32Array.from([3, 4, 5, 0, 1, 2]) }]) {
      const drawn = picture(20, 20);
      drawShape(drawn, order, quarterTurns([0, 0, 0]), [0, 0, 0], 8, { yaw: 0, pitch: 0 }, [1, 1, 1]);
      assert.ok(drawn.data[4 * (17 * 20 + 3) + 3]! > 0);
    }
  });

  it('outside of the picture is not drawn', () => {
    const drawn = picture(4, 4);
    drawShape(drawn, square, quarterTurns([0, 0, 0]), [100, 0, 0], 1, { yaw: 0, pitch: 0 }, [1, 1, 1]);
    assert.ok(drawn.data.every((value) => value === 0));
  });
});
