// Unit quaternions and rigid transformations. Arrays are x, y, z and w, x, y, z.

export type Vector = readonly [number, number, number];
export type Quaternion = readonly [number, number, number, number];

// The point p of the frame is at `position` + rotate(`orientation`, p).
export interface Pose {
  position: Vector;
  orientation: Quaternion;
}

export function dot(a: Vector, b: Vector): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

export function cross(a: Vector, b: Vector): Vector {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

export function subtract(a: Vector, b: Vector): Vector {
  return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

export function poseFromArray(values: readonly number[]): Pose {
  const [x, y, z, qw, qx, qy, qz] = values as [number, number, number, number, number, number, number];
  return { position: [x, y, z], orientation: normalise([qw, qx, qy, qz]) };
}

export function normalise(q: Quaternion): Quaternion {
  const length = Math.hypot(q[0], q[1], q[2], q[3]);
  return length === 0 ? [1, 0, 0, 0] : [q[0] / length, q[1] / length, q[2] / length, q[3] / length];
}

// First b, then a.
export function multiply(a: Quaternion, b: Quaternion): Quaternion {
  return [
    a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
    a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
    a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
    a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
  ];
}

export function conjugate(q: Quaternion): Quaternion {
  return [q[0], -q[1], -q[2], -q[3]];
}

// Computes v + 2w(u x v) + 2u x (u x v), where u is the vector part.
export function rotate(q: Quaternion, v: Vector): Vector {
  const [w, x, y, z] = q;
  const tx = 2 * (y * v[2] - z * v[1]);
  const ty = 2 * (z * v[0] - x * v[2]);
  const tz = 2 * (x * v[1] - y * v[0]);
  return [
    v[0] + w * tx + y * tz - z * ty,
    v[1] + w * ty + z * tx - x * tz,
    v[2] + w * tz + x * ty - y * tx,
  ];
}

// The rotation of `angle` radians about `axis`, which need not have length 1.
export function fromAxisAngle(axis: Vector, angle: number): Quaternion {
  const length = Math.hypot(axis[0], axis[1], axis[2]);
  const s = length === 0 ? 0 : Math.sin(angle / 2) / length;
  return [Math.cos(angle / 2), axis[0] * s, axis[1] * s, axis[2] * s];
}

// First b, then a.
export function compose(a: Pose, b: Pose): Pose {
  const moved = rotate(a.orientation, b.position);
  return {
    position: [a.position[0] + moved[0], a.position[1] + moved[1], a.position[2] + moved[2]],
    orientation: multiply(a.orientation, b.orientation),
  };
}

export function invert(a: Pose): Pose {
  const orientation = conjugate(a.orientation);
  const [x, y, z] = rotate(orientation, a.position);
  return { position: [-x, -y, -z], orientation };
}

// The rotation about the line through `anchor` along `axis`.
export function rotationAbout(anchor: Vector, axis: Vector, angle: number): Pose {
  const orientation = fromAxisAngle(axis, angle);
  const moved = rotate(orientation, anchor);
  return { position: [anchor[0] - moved[0], anchor[1] - moved[1], anchor[2] - moved[2]], orientation };
}
