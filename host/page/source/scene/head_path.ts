// The line along which the head moved. It is cut where a hand moved the robot.
import * as THREE from 'three';
import type { Vector } from '../geometry/quaternion.js';
import { PathPoints } from './path_points.js';

const mostPoints = 4096;

export class HeadPath {
  readonly line: THREE.LineSegments;
  private readonly points = new PathPoints(mostPoints);
  private readonly positions = new THREE.BufferAttribute(this.points.positions, 3);
  private readonly segments = new THREE.BufferAttribute(this.points.segments, 1);

  constructor(private readonly spacing: number) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', this.positions);
    geometry.setIndex(this.segments);
    // The line is visible through the robot, which mostly lies on its own path.
    this.line = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ depthTest: false, transparent: true }));
    this.line.frustumCulled = false;
    this.show();
  }

  clear(): void {
    this.points.clear();
    this.show();
  }

  // Cuts the line: the next point is not joined to the last one.
  cut(): void {
    this.points.cut();
  }

  // A point closer than `spacing` to the last one is left out.
  add(point: Vector): void {
    if (this.points.add(point, this.spacing)) {
      this.show();
    }
  }

  setColour(colour: THREE.Color): void {
    (this.line.material as THREE.LineBasicMaterial).color = colour;
  }

  private show(): void {
    this.positions.needsUpdate = true;
    this.segments.needsUpdate = true;
    this.line.geometry.setDrawRange(0, this.points.segmentEnds);
  }
}
