// An answer of `search.motion` or `draft.motion`, as the program sends it: raw angles and head in each row.
import { encodeRecordedRows } from './recorded_rows.js';

const degree = 2 ** 31 / 180;

// A robot whose joints have these angles in degrees, and whose head goes a metre along y in each row.
export function motionBytes({ joints = 5, rows = 4, stride = 1, tick = 0, angle = 30 }: { joints?: number; rows?: number; stride?: number; tick?: number; angle?: number } = {}): ArrayBuffer {
  const row = (number: number) => [...new Array<number>(joints).fill(Math.round(angle * degree)), 0, number * 1_000_000, 26_000, 2 ** 30, 0, 0, 0];
  return encodeRecordedRows({ tick, stride, lastTick: tick + (rows - 1) * stride, rows: Array.from({ length: rows }, (_, number) => row(number)) });
}
