// The answer of `recording.rows`: a header of 16 bytes, then int32, little-endian.
import { bytesResultHeader } from './bytes_result.js';

export interface RecordedRows {
  tick: number; // tick of the first row
  stride: number; // ticks from one row to the next; 1: every tick
  rows: number;
  lastTick: number; // last tick of the recording at present
  width: number; // values in a row
  values: Int32Array; // of each row: the values at its tick; with a stride above 1, then the minima, then the maxima
}

const headerBytes = bytesResultHeader + 16;

// Decodes an answer. `width`: number of values of the requested signals. Throws an Error that says what was found and what
// was expected.
export function decodeRecordedRows(buffer: ArrayBuffer, width: number): RecordedRows {
  if (buffer.byteLength < headerBytes) {
    throw new Error(`rows: found ${buffer.byteLength} bytes, expected a header of ${headerBytes} bytes`);
  }
  const header = new DataView(buffer);
  const word = (index: number) => header.getUint32(bytesResultHeader + 4 * index, true);
  const [tick, stride, rows, lastTick] = [word(0), word(1), word(2), word(3)];
  const count = rows * width * (stride === 1 ? 1 : 3);
  if (buffer.byteLength !== headerBytes + 4 * count) {
    throw new Error(`rows: found ${buffer.byteLength} bytes, expected ${headerBytes + 4 * count}`);
  }
  return { tick, stride, rows, lastTick, width, values: new Int32Array(buffer, headerBytes, count) };
}
