// A block of ticks as `proleg export --html` writes it (docs/page-interface.md): columns of differences, little-endian.
import { decodeBase64 } from '../wire/base64.js';

// Decodes the rows, one behind the other. Throws an Error if the bytes are not whole rows.
export function rowsOfColumns(bytes: Uint8Array, width: number): Int32Array {
  if (width === 0 || bytes.length === 0 || bytes.length % (4 * width) !== 0) {
    throw new Error(`block: found ${bytes.length} bytes, expected a multiple of ${4 * width}`);
  }
  const rows = bytes.length / 4 / width;
  const source = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  const values = new Int32Array(rows * width);
  for (let column = 0; column < width; column += 1) {
    let value = 0;
    for (let row = 0; row < rows; row += 1) {
      value = (value + source.getInt32(4 * (column * rows + row), true)) | 0;
      values[row * width + column] = value;
    }
  }
  return values;
}

// Decodes base64 text in zlib format. Throws an Error if the text is damaged.
export async function inflate(text: string): Promise<Uint8Array> {
  const stream = new Blob([decodeBase64(text)]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}
