import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { deflateSync } from 'node:zlib';
import { inflate, rowsOfColumns } from '../../../../host/page/source/data/column_block.js';
import { Random } from '../support/random.js';

// As docs/page-interface.md describes a block.
function bytesOf(rows: readonly (readonly number[])[]): Uint8Array {
  const width = rows[0]?.length ?? 0;
  const differences = Array.from({ length: width }, (_, column) =>
    rows.map((row, i) => (row[column] as number) - (rows[i - 1]?.[column] ?? 0)),
  ).flat();
  const bytes = Buffer.alloc(4 * differences.length);
  differences.forEach((difference, i) => bytes.writeInt32LE(difference | 0, 4 * i));
  return bytes;
}

describe('a block of ticks', () => {
  it('has its rows back', () => {
    assert.deepEqual([...rowsOfColumns(bytesOf([[1, -5], [3, -5], [2, 70000]]), 2)], [1, -5, 3, -5, 2, 70000]);
  });

  it('has the ends of int32 back, whose differences wrap', () => {
    const rows = [[-2147483648], [2147483647], [0], [-1], [-2147483648]];
    assert.deepEqual([...rowsOfColumns(bytesOf(rows), 1)], rows.flat());
  });

  it('has random values back', () => {
    const random = new Random(7);
    const rows = Array.from({ length: 200 }, () => Array.from({ length: 11 }, () => random.integer(-(2 ** 31), 2 ** 31 - 1)));
    assert.deepEqual([...rowsOfColumns(bytesOf(rows), 11)], rows.flat());
  });

  it('reads bytes that begin anywhere in a buffer', () => {
    const bytes = new Uint8Array(9);
    bytes.set(bytesOf([[7], [9]]), 1);
    assert.deepEqual([...rowsOfColumns(bytes.subarray(1), 1)], [7, 9]);
  });

  it('refuses a part of a row', () => {
    assert.throws(() => rowsOfColumns(new Uint8Array(12), 2), /found 12 bytes, expected a multiple of 8/);
    assert.throws(() => rowsOfColumns(new Uint8Array(0), 2), /found 0 bytes/);
  });
});

describe('the text of a block', () => {
  it('is base64 of the zlib format', async () => {
    const bytes = bytesOf([[5, 6], [7, 8]]);
    assert.deepEqual([...(await inflate(deflateSync(bytes).toString('base64')))], [...bytes]);
  });

  it('is refused if it is cut or damaged', async () => {
    const text = deflateSync(bytesOf([[5, 6], [7, 8]])).toString('base64');
    await assert.rejects(inflate(text.slice(0, 8)));
    await assert.rejects(inflate(`AAAA${text.slice(4)}`));
    await assert.rejects(inflate('no base64!'));
  });
});
