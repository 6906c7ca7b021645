// A mesh for the eye: its vertices and triangles, and how they are drawn into a picture.
import { multiply, rotate, type Quaternion, type Vector } from '../geometry/quaternion.js';

export interface MeshShape {
  vertices: Float32Array; // x, y, z of each
  triangles: Uint32Array; // three numbers of vertices of each
}

// The answer of `mesh.shape`, behind the header of answers in bytes.
export function readShape(buffer: ArrayBuffer, header: number): MeshShape {
  const view = new DataView(buffer, header);
  const vertices = view.getUint32(0, true);
  const triangles = view.getUint32(4, true);
  const at = header + 8;
  return {
    vertices: new Float32Array(buffer.slice(at, at + 12 * vertices)),
    triangles: new Uint32Array(buffer.slice(at + 12 * vertices, at + 12 * (vertices + triangles))),
  };
}

// A turn of 90 degrees so often about x, then y, then z.
export function quarterTurns([x, y, z]: readonly [number, number, number]): Quaternion {
  const half = Math.PI / 4;
  const about = (axis: 0 | 1 | 2, turns: number): Quaternion => {
    const q: [number, number, number, number] = [Math.cos(half * turns), 0, 0, 0];
    q[axis + 1] = Math.sin(half * turns);
    return q;
  };
  return multiply(about(2, z), multiply(about(1, y), about(0, x)));
}

export interface Camera {
  yaw: number; // radians
  pitch: number;
}

// Where a point of the turned mesh is in the picture: to the right, downwards, and how near it is.
export function projection({ yaw, pitch }: Camera): (point: Vector) => Vector {
  const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
  return ([x, y, z]) => {
    const right = cy * x + sy * y;
    const away = -sy * x + cy * y;
    return [right, -(cp * z + sp * away), sp * z - cp * away];
  };
}

export interface Picture {
  width: number;
  height: number;
  data: Uint8ClampedArray; // red, green, blue, opacity
}

// Draws the mesh with a depth for each pixel. scale: pixels of a unit; middle: of the mesh, in the middle of the picture.
export function drawShape(picture: Picture, shape: MeshShape, turn: Quaternion, middle: Vector, scale: number, camera: Camera, colour: Vector): void {
  const { width, height, data } = picture;
  const { vertices, triangles } = shape;
  const seen = projection(camera);
  const points = new Float32Array(vertices.length);
  for (let i = 0; i < vertices.length; i += 3) {
    const turned = rotate(turn, [vertices[i]! - middle[0], vertices[i + 1]! - middle[1], vertices[i + 2]! - middle[2]]);
    const [x, y, depth] = seen(turned);
    points[i] = width / 2 + scale * x;
    points[i + 1] = height / 2 + scale * y;
    points[i + 2] = scale * depth;
  }
  const depths = new Float32Array(width * height).fill(-Infinity);
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [3 * triangles[t]!, 3 * triangles[t + 1]!, 3 * triangles[t + 2]!];
    const [ax, ay, az] = [points[a]!, points[a + 1]!, points[a + 2]!];
    const [bx, by, bz] = [points[b]! - ax, points[b + 1]! - ay, points[b + 2]! - az];
    const [cx, cy, cz] = [points[c]! - ax, points[c + 1]! - ay, points[c + 2]! - az];
    const area = bx * cy - by * cx;
    if (area === 0) continue;
    // The normal towards the eye, because both sides of a sheet are seen. Light comes from above, a little from the left.
    const sense = Math.sign(area);
    const normal = [sense * (by * cz - bz * cy), sense * (bz * cx - bx * cz), sense * area] as const;
    const shade = 0.35 + 0.65 * Math.max(0, (-0.35 * normal[0] - 0.75 * normal[1] + 0.56 * normal[2]) / Math.hypot(...normal));
    const left = Math.max(0, Math.ceil(Math.min(ax, ax + bx, ax + cx) - 0.5));
    const right = Math.min(width - 1, Math.floor(Math.max(ax, ax + bx, ax + cx) + 0.5));
    const top = Math.max(0, Math.ceil(Math.min(ay, ay + by, ay + cy) - 0.5));
    const bottom = Math.min(height - 1, Math.floor(Math.max(ay, ay + by, ay + cy) + 0.5));
    for (let y = top; y <= bottom; y += 1) {
      for (let x = left; x <= right; x += 1) {
        const u = ((x - ax) * cy - (y - ay) * cx) / area;
        const v = ((y - ay) * bx - (x - ax) * by) / area;
        if (u < 0 || v < 0 || u + v > 1) continue;
        const depth = az + u * bz + v * cz;
        const at = y * width + x;
        if (depth <= depths[at]!) continue;
        depths[at] = depth;
        data.set([255 * colour[0] * shade, 255 * colour[1] * shade, 255 * colour[2] * shade, 255], 4 * at);
      }
    }
  }
}
