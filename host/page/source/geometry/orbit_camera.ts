// A camera that looks at a target and turns about the vertical through it. z points up.
import type { Vector } from './quaternion.js';

// The limits below are in radians and metres.
const lowestElevation = -0.1;
const highestElevation = 1.55;
const nearest = 0.05;
const farthest = 60;
const radiansPerPixel = 0.008;

export class OrbitCamera {
  target: Vector = [0, 0, 0];
  azimuth = -0.9;
  elevation = 0.5;
  distance = 1;

  get position(): Vector {
    const horizontal = this.distance * Math.cos(this.elevation);
    return [
      this.target[0] + horizontal * Math.cos(this.azimuth),
      this.target[1] + horizontal * Math.sin(this.azimuth),
      this.target[2] + this.distance * Math.sin(this.elevation),
    ];
  }

  turn(rightPixels: number, downPixels: number): void {
    this.azimuth -= rightPixels * radiansPerPixel;
    this.elevation = clamp(this.elevation + downPixels * radiansPerPixel, lowestElevation, highestElevation);
  }

  // The target moves so that what is below the pointer stays below it. `fieldOfView` is vertical, in radians.
  pan(rightPixels: number, downPixels: number, heightPixels: number, fieldOfView: number): void {
    const metres = (2 * this.distance * Math.tan(fieldOfView / 2)) / Math.max(1, heightPixels);
    const right: Vector = [-Math.sin(this.azimuth), Math.cos(this.azimuth), 0];
    const s = Math.sin(this.elevation);
    const up: Vector = [-Math.cos(this.azimuth) * s, -Math.sin(this.azimuth) * s, Math.cos(this.elevation)];
    const [x, y, z] = this.target;
    const along = (axis: 0 | 1 | 2) => (-rightPixels * right[axis] + downPixels * up[axis]) * metres;
    this.target = [x + along(0), y + along(1), z + along(2)];
  }

  // Changes the distance; a factor above 1 increases it.
  zoom(factor: number): void {
    this.distance = clamp(this.distance * factor, nearest, farthest);
  }
}

function clamp(value: number, low: number, high: number): number {
  return Math.min(high, Math.max(low, value));
}
