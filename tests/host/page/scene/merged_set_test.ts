// Shapes that never move are one geometry: what is drawn, coloured and hit is as for shapes by themselves.
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import * as THREE from 'three';
import { fromAxisAngle } from '../../../../host/page/source/geometry/quaternion.js';
import { MergedSet, type StaticShape } from '../../../../host/page/source/scene/merged_set.js';

const upright = [1, 0, 0, 0] as const;

function shape(body: number, changes: Partial<StaticShape> = {}): StaticShape {
  return { link: -1, body, kind: 'box', pose: { position: [0, 3 * body, 0], orientation: upright }, scale: [1, 0.5, 0.25], ...changes };
}

function setOf(...shapes: StaticShape[]): MergedSet {
  return new MergedSet(shapes, new THREE.MeshLambertMaterial({ vertexColors: true }));
}

function sizeOf(set: MergedSet): number[] {
  set.mesh.geometry.computeBoundingBox();
  const { min, max } = set.mesh.geometry.boundingBox as THREE.Box3;
  return [...min.toArray(), ...max.toArray()].map((value) => Math.round(value * 1e4) / 1e4);
}

// Looks along y from a place behind the first shape.
function frustumAt(y: number): THREE.Frustum {
  const camera = new THREE.PerspectiveCamera(40, 1, 0.01, 200);
  camera.up.set(0, 0, 1);
  camera.position.set(0, y, 0);
  camera.lookAt(0, y + 1, 0);
  camera.updateMatrixWorld();
  return new THREE.Frustum().setFromProjectionMatrix(new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse));
}

function shownBodies(set: MergedSet): number[] {
  const index = set.mesh.geometry.index as THREE.BufferAttribute;
  const { start, count } = set.mesh.geometry.drawRange;
  const bodies = new Set<number>();
  for (let i = start; i < Math.min(index.count, start + count); i += 1) {
    bodies.add(set.instanceAt({ face: { a: index.getX(i) } } as THREE.Intersection)?.body ?? -1);
  }
  return [...bodies];
}

describe('shapes that never move', () => {
  it('have their places, sizes and turns in one mesh', () => {
    assert.deepEqual(sizeOf(setOf(shape(0))), [-1, -0.5, -0.25, 1, 0.5, 0.25]);
    const quarter = fromAxisAngle([0, 0, 1], Math.PI / 2);
    assert.deepEqual(sizeOf(setOf(shape(0), shape(1, { pose: { position: [0, 3, 0], orientation: quarter } }))), [-1, -0.5, -0.25, 1, 4, 0.25]);
    assert.deepEqual(sizeOf(setOf(shape(0, { kind: 'sphere', scale: [2, 2, 2] }))).map(Math.round), [-2, -2, -2, 2, 2, 2]);
  });

  it('have normals of length 1 that point away from the surface', () => {
    const { geometry } = setOf(shape(0, { kind: 'cylinder', scale: [1, 3, 1] })).mesh;
    const [positions, normals] = [geometry.getAttribute('position'), geometry.getAttribute('normal')];
    for (let i = 0; i < normals.count; i += 1) {
      const normal = new THREE.Vector3().fromBufferAttribute(normals as THREE.BufferAttribute, i);
      assert.ok(Math.abs(normal.length() - 1) < 1e-5);
      assert.ok(normal.dot(new THREE.Vector3().fromBufferAttribute(positions as THREE.BufferAttribute, i)) > 0);
    }
  });

  it('have colours of their own', () => {
    const set = setOf(shape(0), shape(1));
    set.paint(({ body }) => (body === 1 ? new THREE.Color(1, 0, 0) : new THREE.Color(0, 0, 1)));
    const colours = set.mesh.geometry.getAttribute('color');
    const half = colours.count / 2;
    assert.deepEqual([colours.getX(half - 1), colours.getX(half), colours.getZ(half - 1), colours.getZ(half)], [0, 1, 1, 0]);
  });

  it('are told apart where a ray hits', () => {
    const set = setOf(shape(0), shape(1), shape(2));
    const caster = new THREE.Raycaster(new THREE.Vector3(0.2, 3, 5), new THREE.Vector3(0, 0, -1));
    const hit = caster.intersectObject(set.mesh)[0];
    assert.equal(set.instanceAt(hit as THREE.Intersection)?.body, 1);
  });

  it('are as many as a world has', () => {
    const set = setOf(...Array.from({ length: 500 }, (_, body) => shape(body, { kind: 'sphere' })));
    const index = set.mesh.geometry.index as THREE.BufferAttribute;
    assert.ok(index.array instanceof Uint32Array, 'more vertices than 16 bits have numbers');
    assert.equal(set.instanceAt({ face: { a: index.getX(index.count - 1) } } as THREE.Intersection)?.body, 499);
  });

  it('are drawn if they can be seen', () => {
    const set = setOf(...[0, 1, 2, 3].map((body) => shape(body)));
    assert.deepEqual(shownBodies(set), [0, 1, 2, 3]);
    set.showIn(frustumAt(-5), 100);
    assert.deepEqual(shownBodies(set), [0, 1, 2, 3]);
    set.showIn(frustumAt(4.6), 100);
    assert.deepEqual(shownBodies(set), [2, 3], 'the others are behind the view');
    set.showIn(frustumAt(-5), 9);
    assert.deepEqual(shownBodies(set), [0, 1], 'the others are behind the fog');
    set.showIn(frustumAt(50), 100);
    assert.deepEqual(shownBodies(set), []);
    set.showIn(frustumAt(-5), 100);
    assert.deepEqual(shownBodies(set), [0, 1, 2, 3]);
  });

  it('of kilometres are drawn around what can be seen, and no further than they reach', () => {
    const ground = shape(0, { pose: { position: [0, 0, -0.1], orientation: upright }, scale: [1000, 1000, 0.1] });
    const set = setOf(ground, shape(1));
    set.cutAround(new THREE.Vector3(3, 0, 1), 16);
    assert.deepEqual(sizeOf(set), [-12, -16, -0.25, 20, 16, 0.25], 'the place counts in steps of a quarter of 16 m');
    set.cutAround(new THREE.Vector3(1003, 0, 1), 16);
    assert.deepEqual(sizeOf(set), [-1, -16, -0.25, 1000, 16, 0.25]);
    const [quarter, far] = [fromAxisAngle([0, 0, 1], Math.PI / 2), new THREE.Vector3(0, 400, 0)];
    const turned = setOf(shape(0, { pose: { position: [0, 0, 0], orientation: quarter }, scale: [1000, 50, 1] }));
    turned.cutAround(far, 16);
    assert.deepEqual(sizeOf(turned), [-16, 384, -1, 16, 416, 1]);
    const hit = new THREE.Raycaster(new THREE.Vector3(0, 400, 5), new THREE.Vector3(0, 0, -1)).intersectObject(turned.mesh)[0];
    assert.equal(hit?.point.z, 1, 'rays find it there');
  });
});
