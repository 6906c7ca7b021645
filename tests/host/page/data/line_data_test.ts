import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { lineData } from '../../../../host/page/source/data/line_data.js';
import { TelemetryHistory } from '../../../../host/page/source/data/telemetry_history.js';
import { noValue } from '../../../../host/page/source/wire/messages.js';
import { rowLayout } from '../../../../host/page/source/wire/subscription.js';
import { decodeTelemetry } from '../../../../host/page/source/wire/telemetry_message.js';
import { encodeTelemetry, makeSignal } from '../support/telemetry.js';

function historyOf(rows: number[]): TelemetryHistory {
  const history = new TelemetryHistory();
  const layout = rowLayout([makeSignal('angle', 1, 0.5)]);
  history.append(decodeTelemetry(encodeTelemetry({ tick: 0, rows: rows.map((value) => [value]) })), layout);
  return history;
}

const line = { signal: 'angle', index: 0 };

describe('the points of a line', () => {
  it('are all rows, in the unit of the signal, if there is room for them', () => {
    const { times, values } = lineData(historyOf([2, 4, 6]), [line], 0, 2, 100);
    assert.deepEqual(times, [0, 1, 2]);
    assert.deepEqual(values, [[1, 2, 3]]);
  });

  it('have one row more at each end, so that the line reaches the edges', () => {
    const { times } = lineData(historyOf([0, 1, 2, 3, 4, 5, 6]), [line], 3, 4, 100);
    assert.deepEqual(times, [2, 3, 4]);
  });

  it('are empty where there is no value', () => {
    assert.deepEqual(lineData(historyOf([2, noValue, 6]), [line], 0, 2, 100).values, [[1, null, 3]]);
  });

  it('keep a peak of one tick among ten thousand, on a screen of 100 columns', () => {
    const rows = Array.from({ length: 10000 }, () => 0);
    rows[4321] = 1000;
    rows[8765] = -1000;
    const { times, values } = lineData(historyOf(rows), [line], 0, 9999, 100);
    assert.ok(times.length <= 2 * 101, `found ${times.length} points`);
    const present = (values[0] ?? []).filter((value) => value !== null);
    assert.equal(Math.max(...present), 500);
    assert.equal(Math.min(...present), -500);
    assert.ok(times.every((time, i) => i === 0 || time > (times[i - 1] as number)), 'ascending');
  });

  it('are none for a signal that has never come', () => {
    assert.deepEqual(lineData(historyOf([1, 2]), [{ signal: 'torque', index: 0 }], 0, 1, 100).values, [[null, null]]);
  });
});
