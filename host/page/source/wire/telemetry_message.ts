// Binary messages of telemetry: a header of 16 bytes, then rows of int32, little-endian.

export interface TelemetryMessage {
  subscription: number; // 1 for the viewer's first `subscribe`
  tick: number; // tick of the first row
  rows: number;
  stride: number; // ticks from one row to the next
  run: number; // another number after a restart
  hasGap: boolean; // ticks between the message before and this one are missing
  width: number; // values in a row
  values: Int32Array; // rows * width
}

const headerBytes = 16;

const isLittleEndian = new Uint8Array(new Uint16Array([1]).buffer)[0] === 1;

// Decodes a message. Throws an Error that says what was found and what was expected.
export function decodeTelemetry(buffer: ArrayBuffer): TelemetryMessage {
  if (buffer.byteLength < headerBytes || buffer.byteLength % 4 !== 0) {
    throw new Error(`telemetry: found ${buffer.byteLength} bytes, expected a header of 16 bytes and a multiple of 4`);
  }
  const header = new DataView(buffer);
  const rows = header.getUint16(8, true);
  const count = (buffer.byteLength - headerBytes) / 4;
  if (rows === 0 ? count !== 0 : count % rows !== 0) {
    throw new Error(`telemetry: found ${count} values, expected a multiple of ${rows} rows`);
  }
  return {
    subscription: header.getUint32(0, true),
    tick: header.getUint32(4, true),
    rows,
    stride: header.getUint16(10, true),
    run: header.getUint16(12, true),
    hasGap: (header.getUint16(14, true) & 1) !== 0,
    width: rows === 0 ? 0 : count / rows,
    values: readValues(buffer, header, count),
  };
}

// The values: a view if the processor has the byte order of the wire, else a copy.
function readValues(buffer: ArrayBuffer, header: DataView, count: number): Int32Array {
  if (isLittleEndian) {
    return new Int32Array(buffer, headerBytes, count);
  }
  return Int32Array.from({ length: count }, (_, i) => header.getInt32(headerBytes + 4 * i, true));
}
