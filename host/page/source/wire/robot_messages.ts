// Poses and parameters of a robot in messages (docs/page-interface.md).

// x, y, z in metres, then a unit quaternion w, x, y, z.
export type PoseArray = [number, number, number, number, number, number, number];

// An internal value of a slot, which a change may overwrite.
export interface InternalValue {
  slot: number;
  name: string;
  unit: string;
  scale: number;
  help: string;
  internal: true;
  joints: number[];
  wraps: boolean; // an angle: each number stands for one of -180 to 180 degrees
}

// A parameter of a slot. The arrays have one entry for each joint of `joints`.
export interface Parameter extends Omit<InternalValue, 'internal'> {
  internal: false;
  minimum: number; // raw, as the values below
  maximum: number;
  useful?: [number, number]; // the range that most users need; missing: from minimum to maximum
  default: number;
  file: number[];
  wanted: number[];
  confirmed: number[];
  tick: number[]; // tick from which the confirmed value holds
}
