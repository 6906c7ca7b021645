import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { decodeTelemetry } from '../../../../host/page/source/wire/telemetry_message.js';
import { encodeTelemetry } from '../support/telemetry.js';

describe('a message of telemetry', () => {
  it('has its header fields at the offsets of docs/page-interface.md', () => {
    const bytes = new Uint8Array(16 + 8);
    bytes.set([2, 0, 0, 0, 0x10, 0x27, 0, 0, 1, 0, 4, 0, 7, 0, 1, 0, 0xff, 0xff, 0xff, 0xff, 0, 0, 0, 0x80]);
    const message = decodeTelemetry(bytes.buffer);
    assert.equal(message.subscription, 2);
    assert.equal(message.tick, 10000);
    assert.equal(message.rows, 1);
    assert.equal(message.stride, 4);
    assert.equal(message.run, 7);
    assert.equal(message.hasGap, true);
    assert.deepEqual([...message.values], [-1, -2147483648]);
  });

  it('has rows one behind the other', () => {
    const message = decodeTelemetry(encodeTelemetry({ tick: 5, rows: [[1, 2, 3], [4, 5, 6]] }));
    assert.equal(message.width, 3);
    assert.deepEqual([...message.values], [1, 2, 3, 4, 5, 6]);
    assert.equal(message.hasGap, false);
  });

  it('may have no rows', () => {
    assert.equal(decodeTelemetry(encodeTelemetry({ tick: 5, rows: [] })).width, 0);
  });

  it('is rejected if it is shorter than its header', () => {
    assert.throws(() => decodeTelemetry(new ArrayBuffer(12)), /found 12 bytes, expected a header/);
  });

  it('is rejected if its values do not fill its rows', () => {
    const buffer = encodeTelemetry({ tick: 0, rows: [[1, 2, 3]] });
    new DataView(buffer).setUint16(8, 2, true);
    assert.throws(() => decodeTelemetry(buffer), /found 3 values, expected a multiple of 2 rows/);
  });
});
