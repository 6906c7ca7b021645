import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { rowLayout, Subscriptions } from '../../../../host/page/source/wire/subscription.js';
import { makeSignal } from '../support/telemetry.js';

const angle = makeSignal('angle', 5);
const head = makeSignal('head', 7);
const contact = makeSignal('contact', 6);

describe('a row of a subscription', () => {
  it('has the signals in the order of the subscription', () => {
    const layout = rowLayout([head, angle, contact]);
    assert.deepEqual(
      layout.signals.map(({ signal, offset }) => [signal.name, offset]),
      [['head', 0], ['angle', 7], ['contact', 12]],
    );
    assert.equal(layout.width, 18);
  });
});

describe('subscriptions', () => {
  it('are numbered from 1', () => {
    const subscriptions = new Subscriptions();
    assert.deepEqual(subscriptions.select([angle]), ['angle']);
    assert.equal(subscriptions.layoutOf(1)?.width, 5);
    assert.equal(subscriptions.layoutOf(2), null);
  });

  it('are not repeated if nothing changed', () => {
    const subscriptions = new Subscriptions();
    subscriptions.select([angle, head]);
    assert.equal(subscriptions.select([angle, head]), null);
    assert.deepEqual(subscriptions.select([head, angle]), ['head', 'angle']);
  });

  it('are made anew if a signal has another number of values', () => {
    const subscriptions = new Subscriptions();
    subscriptions.select([angle]);
    assert.deepEqual(subscriptions.select([makeSignal('angle', 60)]), ['angle']);
    assert.equal(subscriptions.layoutOf(2)?.width, 60);
  });

  it('explain messages that were on their way when the selection changed', () => {
    const subscriptions = new Subscriptions();
    subscriptions.select([angle]);
    subscriptions.select([angle, head]);
    assert.equal(subscriptions.layoutOf(1)?.width, 5);
    assert.equal(subscriptions.layoutOf(2)?.width, 12);
    assert.equal(subscriptions.layoutOf(1), null, 'no message of an earlier subscription can follow');
  });
});
