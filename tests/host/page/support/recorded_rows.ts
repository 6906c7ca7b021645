// An answer of `recording.rows`, as the program sends it.
export function encodeRecordedRows(answer: { id?: number; tick: number; stride: number; lastTick: number; rows: number[][] }): ArrayBuffer {
  const values = answer.rows.flat();
  const bytes = new ArrayBuffer(32 + 4 * values.length);
  const view = new DataView(bytes);
  const words = [0, 0, answer.id ?? 1, 0, answer.tick, answer.stride, answer.rows.length, answer.lastTick];
  words.forEach((word, i) => view.setUint32(4 * i, word, true));
  values.forEach((value, i) => view.setInt32(32 + 4 * i, value, true));
  return bytes;
}
