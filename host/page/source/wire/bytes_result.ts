// Binary answers: a header of 16 bytes (0 in the place of telemetry's number of a subscription; the id of the operation),
// then the bytes of the answer.

export const bytesResultHeader = 16;

// The id of the operation that the message answers; null if it is telemetry.
export function answeredBy(buffer: ArrayBuffer): number | null {
  const header = new DataView(buffer);
  if (buffer.byteLength < bytesResultHeader || header.getUint32(0, true) !== 0) {
    return null;
  }
  return header.getUint32(8, true) + header.getUint32(12, true) * 2 ** 32;
}
