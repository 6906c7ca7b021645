// Shapes of one kind, which are drawn with one call and move by themselves.
import * as THREE from 'three';
import { compose, type Pose, type Vector } from '../geometry/quaternion.js';

// A shape of a body, or a mark on it.
export interface Instance {
  link: number; // -1: does not move
  body: number; // position in the list of links, of the terrain, or of objects
  pose: Pose; // in the link's frame
  scale: Vector;
}

// Shapes that are drawn together.
export interface DrawnSet {
  readonly mesh: THREE.Mesh;
  readonly isColoured: boolean; // the shapes have colours of their own
  paint(colourOf: (instance: Instance, index: number) => THREE.Color): void;
  // What a ray has hit.
  instanceAt(hit: THREE.Intersection): Instance | undefined;
  dispose(): void;
}

export class InstanceSet implements DrawnSet {
  readonly mesh: THREE.InstancedMesh;
  private readonly matrix = new THREE.Matrix4();
  private readonly quaternion = new THREE.Quaternion();
  private readonly position = new THREE.Vector3();
  private readonly scale = new THREE.Vector3();

  constructor(
    geometry: THREE.BufferGeometry,
    readonly instances: readonly Instance[],
    material: THREE.Material,
    readonly isColoured = false, // the shape has colours of its own
  ) {
    this.mesh = new THREE.InstancedMesh(geometry, material, instances.length);
    this.mesh.frustumCulled = false;
    this.mesh.castShadow = true;
    this.mesh.receiveShadow = true;
  }

  place(links: readonly Pose[]): void {
    this.instances.forEach((instance, i) => {
      const link = links[instance.link];
      const pose = link === undefined ? instance.pose : compose(link, instance.pose);
      const [w, x, y, z] = pose.orientation;
      this.matrix.compose(
        this.position.set(...pose.position),
        this.quaternion.set(x, y, z, w),
        this.scale.set(...instance.scale),
      );
      this.mesh.setMatrixAt(i, this.matrix);
    });
    this.mesh.instanceMatrix.needsUpdate = true;
  }

  paint(colourOf: (instance: Instance, index: number) => THREE.Color): void {
    this.instances.forEach((instance, i) => this.mesh.setColorAt(i, colourOf(instance, i)));
    if (this.mesh.instanceColor !== null) {
      this.mesh.instanceColor.needsUpdate = true;
    }
  }

  instanceAt({ instanceId }: THREE.Intersection): Instance | undefined {
    return this.instances[instanceId ?? -1];
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.dispose();
  }
}
