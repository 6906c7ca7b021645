import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { divergingScale, fillStrip, largestMagnitude } from '../../../../host/page/source/data/strip_image.js';
import { TelemetryHistory } from '../../../../host/page/source/data/telemetry_history.js';
import { noValue } from '../../../../host/page/source/wire/messages.js';
import { rowLayout } from '../../../../host/page/source/wire/subscription.js';
import { decodeTelemetry } from '../../../../host/page/source/wire/telemetry_message.js';
import { encodeTelemetry, makeSignal } from '../support/telemetry.js';

const scale = divergingScale(0x0000ff, 0xffffff, 0xff0000, 255);
const blue = 0xffff0000; // ABGR
const white = 0xffffffff;
const red = 0xff0000ff;

function strip(history: TelemetryHistory, columns: number, rows: number, from: number, to: number): number[] {
  const pixels = new Uint32Array(columns * rows);
  fillStrip({ pixels, columns, rows }, history, 'angle', from, to, 100, scale);
  return [...pixels];
}

function historyOf(rows: number[][], stride = 1): TelemetryHistory {
  const history = new TelemetryHistory();
  const layout = rowLayout([makeSignal('angle', rows[0]?.length ?? 1)]);
  history.append(decodeTelemetry(encodeTelemetry({ tick: 0, stride, rows })), layout);
  return history;
}

describe('the colour scale', () => {
  it('goes from the low colour over the middle one to the high colour', () => {
    assert.deepEqual([scale[0], scale[127], scale[254]], [blue, white, red]);
  });
});

describe('the strip', () => {
  it('has a row for each joint and a column for each tick', () => {
    const history = historyOf([[-100, 100], [0, 0], [100, -100]]);
    assert.deepEqual(strip(history, 3, 2, 0, 3), [blue, white, red, red, white, blue]);
  });

  it('cuts values beyond the ends of the scale', () => {
    assert.deepEqual(strip(historyOf([[-999], [999]]), 2, 1, 0, 2), [blue, red]);
  });

  it('is transparent where there is no value and where nothing has come yet', () => {
    assert.deepEqual(strip(historyOf([[100], [noValue]]), 4, 1, 0, 4), [red, 0, 0, 0]);
  });

  it('fills the columns between rows that are some ticks apart', () => {
    assert.deepEqual(strip(historyOf([[100], [-100]], 2), 4, 1, 0, 4).slice(0, 3), [red, red, blue]);
  });

  it('shows the last value of each column if there are more ticks than columns', () => {
    assert.deepEqual(strip(historyOf([[0], [100], [0], [-100]]), 2, 1, 0, 4), [red, blue]);
  });
});

describe('the largest magnitude', () => {
  it('is that of all joints in the range', () => {
    const history = historyOf([[1, 2], [-50, 3], [4, 5]]);
    assert.equal(largestMagnitude(history, 'angle', 0, 2), 50);
    assert.equal(largestMagnitude(history, 'angle', 2, 2), 5);
    assert.equal(largestMagnitude(history, 'torque', 0, 2), 0);
  });
});
