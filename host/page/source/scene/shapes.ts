// Geometries of shapes.
import * as THREE from 'three';
import type { Vector } from '../geometry/quaternion.js';
import { decodeBase64 } from '../wire/base64.js';
import type { Mesh, Shape } from '../wire/messages.js';

export const primitives = ['box', 'sphere', 'cylinder'] as const;
export type Primitive = (typeof primitives)[number];

// Of half sides, radius and half height 1.
export const unitGeometry: Record<Primitive, () => THREE.BufferGeometry> = {
  box: () => new THREE.BoxGeometry(2, 2, 2),
  sphere: () => new THREE.SphereGeometry(1, 24, 16),
  cylinder: () => new THREE.CylinderGeometry(1, 1, 2, 24),
};

export function scaleOf(shape: Shape): Vector {
  const [a, b, c] = shape.size;
  switch (shape.kind) {
    case 'box':
      return [a, b, c];
    case 'sphere':
      return [a, a, a];
    case 'cylinder':
      return [a, b, a];
    case 'mesh':
      return [1, 1, 1];
  }
}

// The geometry has a normal for each triangle, not for each vertex, so that edges are visible.
export function geometryOf(mesh: Mesh): THREE.BufferGeometry {
  const geometry = new THREE.BufferGeometry();
  const vertices = new Float32Array(decodeBase64(mesh.vertices).buffer);
  const count = vertices.length / 3;
  geometry.setAttribute('position', new THREE.BufferAttribute(vertices, 3));
  if (mesh.colours.length > 0) {
    const given = decodeBase64(mesh.colours);
    const colours = given.length === 3 * count ? given : [];
    const linear = new THREE.Color();
    const parts = new Float32Array(3 * count);
    for (let i = 0; i < count; i += 1) {
      const part = (k: number) => (colours[3 * i + k] ?? 160) / 255;
      linear.setRGB(part(0), part(1), part(2), THREE.SRGBColorSpace).toArray(parts, 3 * i);
    }
    geometry.setAttribute('color', new THREE.BufferAttribute(parts, 3));
  }
  geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(decodeBase64(mesh.triangles).buffer), 1));
  const apart = geometry.toNonIndexed();
  geometry.dispose();
  apart.computeVertexNormals();
  return apart;
}
