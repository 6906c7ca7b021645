// Shapes that never move, as one geometry: one call draws all of them. An instance of an instanced mesh costs a renderer
// without a graphics processor as much as a call, 20 us.
import * as THREE from 'three';
import type { DrawnSet, Instance } from './instance_set.js';
import { type Primitive, unitGeometry } from './shapes.js';

export interface StaticShape extends Instance {
  kind: Primitive;
}

export class MergedSet implements DrawnSet {
  readonly mesh: THREE.Mesh;
  readonly isColoured = false;
  private readonly starts: number[] = []; // first vertex of each shape
  private readonly cornerStarts: number[] = []; // first corner of a triangle
  private readonly corners: Uint16Array | Uint32Array; // of all shapes; the index has those of the shown ones
  private readonly spheres: readonly THREE.Sphere[]; // around the shapes
  private readonly unitVertices: Float32Array; // of the shapes at size 1: of a box -1 or 1
  private cut = '';
  private shown: readonly boolean[];
  private readonly colours: THREE.BufferAttribute;

  constructor(
    readonly shapes: readonly StaticShape[],
    material: THREE.Material,
  ) {
    const units = new Map<Primitive, THREE.BufferGeometry>();
    const unitOf = (kind: Primitive) => {
      const unit = units.get(kind) ?? unitGeometry[kind]();
      units.set(kind, unit);
      return unit;
    };
    let vertices = 0;
    let corners = 0;
    for (const { kind } of shapes) {
      const unit = unitOf(kind);
      this.starts.push(vertices);
      this.cornerStarts.push(corners);
      vertices += (unit.getAttribute('position') as THREE.BufferAttribute).count;
      corners += (unit.index as THREE.BufferAttribute).count;
    }
    const positions = new THREE.BufferAttribute(new Float32Array(3 * vertices), 3);
    const normals = new THREE.BufferAttribute(new Float32Array(3 * vertices), 3);
    this.unitVertices = new Float32Array(3 * vertices);
    this.corners = vertices > 65535 ? new Uint32Array(corners) : new Uint16Array(corners);
    this.colours = new THREE.BufferAttribute(new Float32Array(3 * vertices), 3);
    const matrix = new THREE.Matrix4();
    const normalMatrix = new THREE.Matrix3();
    const vector = new THREE.Vector3();
    let corner = 0;
    shapes.forEach(({ kind, pose, scale }, number) => {
      const unit = unitOf(kind);
      const start = this.starts[number] as number;
      const [w, x, y, z] = pose.orientation;
      matrix.compose(new THREE.Vector3(...pose.position), new THREE.Quaternion(x, y, z, w), new THREE.Vector3(...scale));
      normalMatrix.getNormalMatrix(matrix);
      const from = { positions: unit.getAttribute('position'), normals: unit.getAttribute('normal') };
      this.unitVertices.set(from.positions.array, 3 * start);
      for (let i = 0; i < from.positions.count; i += 1) {
        positions.setXYZ(start + i, ...vector.fromBufferAttribute(from.positions, i).applyMatrix4(matrix).toArray());
        normals.setXYZ(start + i, ...vector.fromBufferAttribute(from.normals, i).applyNormalMatrix(normalMatrix).toArray());
      }
      for (const vertex of (unit.index as THREE.BufferAttribute).array) this.corners[corner++] = start + vertex;
    });
    units.forEach((unit) => unit.dispose());
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', positions);
    geometry.setAttribute('normal', normals);
    geometry.setAttribute('color', this.colours);
    geometry.setIndex(new THREE.BufferAttribute(this.corners.slice(), 1));
    this.shown = shapes.map(() => true);
    this.spheres = shapes.map(({ pose, scale }) => new THREE.Sphere(new THREE.Vector3(...pose.position), Math.hypot(...scale)));
    this.mesh = new THREE.Mesh(geometry, material);
    this.mesh.frustumCulled = false; // the ground is everywhere
    this.mesh.receiveShadow = true;
  }

  paint(colourOf: (instance: Instance, index: number) => THREE.Color): void {
    this.shapes.forEach((shape, number) => {
      const { r, g, b } = colourOf(shape, number);
      const end = this.starts[number + 1] ?? this.colours.count;
      for (let i = this.starts[number] as number; i < end; i += 1) this.colours.setXYZ(i, r, g, b);
    });
    this.colours.needsUpdate = true;
  }

  // Draws of a box that is much larger, such as the ground, only what is within `reach` of a place, in metres: the depth of
  // triangles of kilometres is inexact, so that they hide lines and feet on them.
  cutAround(place: THREE.Vector3, reach: number): void {
    const step = reach / 4; // the place moves so far before anything is done
    const [x, y, z] = place.toArray().map((value) => Math.round(value / step) * step);
    const key = [x, y, z, reach].join();
    if (key === this.cut) {
      return;
    }
    this.cut = key;
    const positions = this.mesh.geometry.getAttribute('position') as THREE.BufferAttribute;
    const vector = new THREE.Vector3();
    this.shapes.forEach(({ kind, pose, scale }, number) => {
      if (kind !== 'box' || Math.max(...scale) < 2 * reach) return;
      const [qw, qx, qy, qz] = pose.orientation;
      const turn = new THREE.Quaternion(qx, qy, qz, qw);
      const origin = new THREE.Vector3(...pose.position);
      const middle = new THREE.Vector3(x, y, z).sub(origin).applyQuaternion(turn.clone().invert()).toArray();
      const end = (sign: number, axis: 0 | 1 | 2) => {
        const bounds = [middle[axis] - reach, middle[axis] + reach].map((value) => Math.min(scale[axis], Math.max(-scale[axis], value)));
        return bounds[sign < 0 ? 0 : 1] as number;
      };
      for (let i = this.starts[number] as number; i < (this.starts[number + 1] ?? positions.count); i += 1) {
        vector.fromArray(this.unitVertices, 3 * i);
        vector.set(end(vector.x, 0), end(vector.y, 1), end(vector.z, 2)).applyQuaternion(turn).add(origin);
        positions.setXYZ(i, ...vector.toArray());
      }
      positions.needsUpdate = true;
      this.mesh.geometry.boundingSphere = null; // of the rays: it is computed again
    });
  }

  // Draws only the shapes that can be seen: in the frustum, and nearer than a distance along the view, in metres.
  showIn(frustum: THREE.Frustum, farthest: number): void {
    const near = frustum.planes[5] as THREE.Plane;
    const isSeen = (sphere: THREE.Sphere) =>
      frustum.intersectsSphere(sphere) && near.distanceToPoint(sphere.center) - sphere.radius < farthest;
    const shown = this.spheres.map(isSeen);
    if (shown.every((isShown, number) => isShown === this.shown[number])) {
      return;
    }
    this.shown = shown;
    const index = this.mesh.geometry.index as THREE.BufferAttribute;
    let count = 0;
    shown.forEach((isShown, number) => {
      if (!isShown) return;
      const part = this.corners.subarray(this.cornerStarts[number], this.cornerStarts[number + 1]);
      index.array.set(part, count);
      count += part.length;
    });
    index.needsUpdate = true;
    this.mesh.geometry.setDrawRange(0, count);
  }

  instanceAt({ face }: THREE.Intersection): Instance | undefined {
    const vertex = face?.a ?? -1;
    return this.shapes[this.starts.filter((start) => start <= vertex).length - 1];
  }

  dispose(): void {
    this.mesh.geometry.dispose();
  }
}
