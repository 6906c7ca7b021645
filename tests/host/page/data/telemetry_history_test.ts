import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { pyramidBlock } from '../../../../host/page/source/data/min_max_pyramid.js';
import { TelemetryHistory } from '../../../../host/page/source/data/telemetry_history.js';
import { noValue } from '../../../../host/page/source/wire/messages.js';
import { rowLayout } from '../../../../host/page/source/wire/subscription.js';
import { decodeTelemetry } from '../../../../host/page/source/wire/telemetry_message.js';
import { encodeTelemetry, makeSignal, type MessageFields } from '../support/telemetry.js';

const angle = rowLayout([makeSignal('angle', 2)]);
const both = rowLayout([makeSignal('torque', 1), makeSignal('angle', 2)]);
const message = (fields: MessageFields) => decodeTelemetry(encodeTelemetry(fields));

describe('the history of telemetry', () => {
  it('finds values by signal, joint and row', () => {
    const history = new TelemetryHistory();
    history.append(message({ tick: 10, rows: [[1, 2], [3, 4]] }), angle);
    assert.equal(history.end, 2);
    assert.equal(history.valueAt('angle', 1, 0), 2);
    assert.equal(history.valueAt('angle', 0, 1), 3);
    assert.equal(history.lastTick(), 11);
  });

  it('has no value for a signal, a joint or a row that is not there', () => {
    const history = new TelemetryHistory();
    history.append(message({ tick: 10, rows: [[1, 2]] }), angle);
    assert.equal(history.valueAt('torque', 0, 0), noValue);
    assert.equal(history.valueAt('angle', 2, 0), noValue);
    assert.equal(history.valueAt('angle', 0, 1), noValue);
    assert.equal(history.valueAt('angle', 0, -1), noValue);
  });

  it('keeps the values of a signal when the subscription changes', () => {
    const history = new TelemetryHistory();
    history.append(message({ tick: 0, rows: [[1, 2]] }), angle);
    history.append(message({ tick: 1, rows: [[7, 3, 4]] }), both);
    assert.deepEqual([history.valueAt('angle', 0, 0), history.valueAt('angle', 0, 1)], [1, 3]);
    assert.deepEqual([history.valueAt('torque', 0, 0), history.valueAt('torque', 0, 1)], [noValue, 7]);
  });

  it('has no value where a signal was not subscribed, also where the ring wraps', () => {
    const history = new TelemetryHistory(pyramidBlock);
    history.append(message({ tick: 0, rows: [[7, 1, 2]] }), both);
    for (let tick = 1; tick <= pyramidBlock; tick += 1) {
      history.append(message({ tick, rows: [[tick, 0]] }), angle);
    }
    assert.equal(history.first, 1);
    assert.equal(history.valueAt('angle', 0, 0), noValue, 'overwritten');
    assert.equal(history.valueAt('angle', 0, pyramidBlock), pyramidBlock);
    assert.equal(history.valueAt('torque', 0, pyramidBlock), noValue, 'not the value of the row that was there before');
  });

  it('finds the first row of a tick or after it, with a stride and after a gap', () => {
    const history = new TelemetryHistory();
    history.append(message({ tick: 100, stride: 4, rows: [[1, 1], [2, 2], [3, 3]] }), angle);
    assert.equal(history.rowAtTick(0), 0);
    assert.equal(history.rowAtTick(104), 1);
    assert.equal(history.rowAtTick(105), 2);
    assert.equal(history.rowAtTick(109), 3, 'the end: there is none');
  });

  it('has a row without values where ticks are missing', () => {
    const history = new TelemetryHistory();
    history.append(message({ tick: 1, rows: [[1, 1]] }), angle);
    history.append(message({ tick: 50, hasGap: true, rows: [[2, 2]] }), angle);
    assert.equal(history.end, 3);
    assert.equal(history.tickOf(1), 49);
    assert.equal(history.valueAt('angle', 0, 1), noValue);
    assert.equal(history.valueAt('angle', 0, 2), 2);
  });

  it('forgets everything when another run begins', () => {
    const history = new TelemetryHistory();
    history.append(message({ tick: 500, run: 1, rows: [[1, 1]] }), angle);
    history.append(message({ tick: 1, run: 2, rows: [[9, 9]] }), angle);
    assert.equal(history.end, 1);
    assert.equal(history.lastTick(), 1);
    assert.equal(history.valueAt('angle', 0, 0), 9);
  });

  it('rejects rows of another width than the subscription', () => {
    const history = new TelemetryHistory();
    assert.throws(() => history.append(message({ tick: 0, rows: [[1, 2, 3]] }), angle), /found 3 values in a row, expected 2/);
  });
});
