// The points of a path in pieces, and the segments between them. It has room for a number of points; when it is full, every
// second point is removed.
import type { Vector } from '../geometry/quaternion.js';

export class PathPoints {
  readonly positions: Float32Array; // x, y, z of each point
  readonly segments: Uint16Array; // the two points of each segment
  count = 0;
  segmentEnds = 0; // count of the used numbers in `segments`
  private readonly begins: boolean[] = []; // whether each point begins a piece
  private isCut = true;

  // capacity: even, at most 65536.
  constructor(private readonly capacity: number) {
    this.positions = new Float32Array(3 * capacity);
    this.segments = new Uint16Array(2 * capacity);
  }

  clear(): void {
    this.count = 0;
    this.segmentEnds = 0;
    this.isCut = true;
  }

  // Makes the next point begin a piece.
  cut(): void {
    this.isCut = true;
  }

  // Adds a point. Returns false if it is left out, because it is closer than `spacing` to the last one.
  add(point: Vector, spacing: number): boolean {
    if (!this.isCut && Math.hypot(...point.map((value, axis) => value - (this.positions[3 * (this.count - 1) + axis] as number))) < spacing) {
      return false;
    }
    if (this.count === this.capacity) {
      this.dropEverySecond();
    }
    this.positions.set(point, 3 * this.count);
    this.append(this.isCut);
    this.isCut = false;
    return true;
  }

  private append(begins: boolean): void {
    this.begins[this.count] = begins;
    if (!begins) {
      this.segments[this.segmentEnds] = this.count - 1;
      this.segments[this.segmentEnds + 1] = this.count;
      this.segmentEnds += 2;
    }
    this.count += 1;
  }

  private dropEverySecond(): void {
    const kept = this.count / 2;
    this.isCut ||= this.begins[this.count - 1] === true; // the last point is removed
    this.count = 0;
    this.segmentEnds = 0;
    for (let i = 0; i < kept; i += 1) {
      this.positions.copyWithin(3 * i, 6 * i, 6 * i + 3);
      // The point before, which is removed, may have begun the piece.
      this.append(this.begins[2 * i] === true || (i > 0 && this.begins[2 * i - 1] === true));
    }
  }
}
