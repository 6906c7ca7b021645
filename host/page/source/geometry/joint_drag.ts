// Turns a joint by dragging a point of its link: the point goes round the joint's axis, in the plane in which it was grabbed.
import { cross, dot, subtract, type Vector } from './quaternion.js';

export interface Ray {
  origin: Vector;
  direction: Vector; // direction with length 1
}

const flattestView = 0.12; // cosine: about 7 degrees between ray and plane; below that a pixel is a wide angle
const shortestArm = 0.002; // shortest distance in metres from the axis to the point

export class JointDrag {
  private turns = 0;
  private last = 0;

  private constructor(
    private readonly point: Vector,
    private readonly centre: Vector,
    private readonly axis: Vector,
  ) {}

  // `axis` has length 1. Null if the point cannot be dragged sensibly: it is on the axis, or its plane is seen from the side.
  static begin(ray: Ray, point: Vector, anchor: Vector, axis: Vector): JointDrag | null {
    const along = dot(subtract(point, anchor), axis);
    const centre: Vector = [anchor[0] + along * axis[0], anchor[1] + along * axis[1], anchor[2] + along * axis[2]];
    const isFlat = Math.abs(dot(ray.direction, axis)) < flattestView;
    return isFlat || Math.hypot(...subtract(point, centre)) < shortestArm ? null : new JointDrag(point, centre, axis);
  }

  // The angle in radians about the axis since the grab; it may be more than a turn.
  angleOf(ray: Ray): number {
    const slope = dot(ray.direction, this.axis);
    const distance = dot(subtract(this.point, ray.origin), this.axis) / slope;
    if (Math.abs(slope) >= flattestView / 4 && distance > 0) {
      const hit: Vector = [
        ray.origin[0] + distance * ray.direction[0],
        ray.origin[1] + distance * ray.direction[1],
        ray.origin[2] + distance * ray.direction[2],
      ];
      const from = subtract(this.point, this.centre);
      const to = subtract(hit, this.centre);
      const angle = Math.atan2(dot(this.axis, cross(from, to)), dot(from, to));
      // A step of more than half a turn means that the point went the other way round.
      this.turns += Math.round((this.last - angle) / (2 * Math.PI));
      this.last = angle;
    }
    return this.last + this.turns * 2 * Math.PI;
  }
}
