import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { answeredBy } from '../../../../host/page/source/wire/bytes_result.js';
import { decodeRecordedRows } from '../../../../host/page/source/wire/recorded_rows.js';
import { encodeRecordedRows } from '../support/recorded_rows.js';
import { encodeTelemetry } from '../support/telemetry.js';

describe('an answer in bytes', () => {
  it('has the id of its operation, also above 2^32', () => {
    const bytes = new Uint8Array(20);
    bytes.set([0, 0, 0, 0, 0, 0, 0, 0, 5, 4, 3, 2, 1]);
    assert.equal(answeredBy(bytes.buffer), 0x0102030405);
  });

  it('is told apart from telemetry', () => {
    assert.equal(answeredBy(encodeTelemetry({ tick: 5, rows: [[1]] })), null);
    assert.equal(answeredBy(new ArrayBuffer(4)), null);
  });
});

describe('rows of a recording', () => {
  it('have their header fields at the offsets of docs/page-interface.md', () => {
    const rows = decodeRecordedRows(encodeRecordedRows({ tick: 300, stride: 1, lastTick: 70000, rows: [[1, -2], [3, 4]] }), 2);
    assert.deepEqual({ ...rows, values: [...rows.values] }, { tick: 300, stride: 1, rows: 2, lastTick: 70000, width: 2, values: [1, -2, 3, 4] });
  });

  it('have three times as many values in blocks', () => {
    const rows = decodeRecordedRows(encodeRecordedRows({ tick: 0, stride: 8, lastTick: 20, rows: [[1, 2, 3]] }), 1);
    assert.equal(rows.rows, 1);
    assert.deepEqual([...rows.values], [1, 2, 3]);
  });

  it('are rejected if they are cut, or of other signals', () => {
    const whole = encodeRecordedRows({ tick: 0, stride: 1, lastTick: 20, rows: [[1, 2]] });
    assert.throws(() => decodeRecordedRows(whole.slice(0, 36), 2), /found 36 bytes, expected 40/);
    assert.throws(() => decodeRecordedRows(whole.slice(0, 20), 2), /found 20 bytes, expected a header/);
    assert.throws(() => decodeRecordedRows(whole, 3), /found 40 bytes, expected 44/);
  });
});
