// An answer of `search.motion`, as the program sends it: raw angles and head in each row.

const degree = 2 ** 31 / 180;

// A robot whose joints have these angles in degrees, and whose head goes a metre along y in each row. tick: microseconds.
export function motionBytes({ joints = 5, rows = 4, stride = 1, tick = 10_000, angle = 30 }: { joints?: number; rows?: number; stride?: number; tick?: number; angle?: number } = {}): ArrayBuffer {
  const row = (number: number) => [...new Array<number>(joints).fill(Math.round(angle * degree)), 0, number * 1_000_000, 26_000, 2 ** 30, 0, 0, 0];
  const answer = [0, 0, 1, 0]; // to which operation
  const numbers = [...answer, tick, stride, rows, joints, ...Array.from({ length: rows }, (_, number) => row(number)).flat()];
  const bytes = new DataView(new ArrayBuffer(4 * numbers.length));
  numbers.forEach((number, i) => bytes.setInt32(4 * i, number, true));
  return bytes.buffer;
}
