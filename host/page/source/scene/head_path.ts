// The line along which the head moved.
import * as THREE from 'three';
import type { Vector } from '../geometry/quaternion.js';

const mostPoints = 4096;

export class HeadPath {
  readonly line: THREE.Line;
  private readonly positions = new THREE.BufferAttribute(new Float32Array(mostPoints * 3), 3);
  private count = 0;

  constructor(private readonly spacing: number) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', this.positions);
    // Seen through the robot, which mostly lies on its own path.
    this.line = new THREE.Line(geometry, new THREE.LineBasicMaterial({ depthTest: false, transparent: true }));
    this.line.frustumCulled = false;
    this.clear();
  }

  clear(): void {
    this.count = 0;
    this.line.geometry.setDrawRange(0, 0);
  }

  // A point closer than `spacing` to the last one is left out.
  add(point: Vector): void {
    const { positions } = this;
    if (this.count > 0) {
      const last = this.count - 1;
      const [x, y, z] = [positions.getX(last), positions.getY(last), positions.getZ(last)];
      if (Math.hypot(point[0] - x, point[1] - y, point[2] - z) < this.spacing) {
        return;
      }
    }
    if (this.count === mostPoints) {
      this.dropEverySecond();
    }
    positions.setXYZ(this.count, ...point);
    this.count += 1;
    positions.needsUpdate = true;
    this.line.geometry.setDrawRange(0, this.count);
  }

  setColour(colour: THREE.Color): void {
    (this.line.material as THREE.LineBasicMaterial).color = colour;
  }

  private dropEverySecond(): void {
    this.count /= 2;
    for (let i = 0; i < this.count; i += 1) {
      this.positions.copyAt(i, this.positions, 2 * i);
    }
  }
}
