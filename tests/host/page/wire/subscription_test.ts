import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { rowLayout, Subscriptions } from '../../../../host/page/source/wire/subscription.js';
import { makeSignal } from '../support/telemetry.js';

const angle = makeSignal('angle', 5);
const head = makeSignal('head', 7);
const contact = makeSignal('contact', 6);
const revision = () => ({ hash: 1, tick_us: 10000, signals: [angle, head, contact] });

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
    const document = revision();
    assert.deepEqual(subscriptions.select(document, [angle]), ['angle']);
    assert.equal(subscriptions.layoutOf(1)?.width, 5);
    assert.equal(subscriptions.layoutOf(2), null);
  });

  it('are not repeated if nothing changed', () => {
    const subscriptions = new Subscriptions();
    const document = revision();
    subscriptions.select(document, [angle, head]);
    assert.equal(subscriptions.select(document, [angle, head]), null);
    assert.deepEqual(subscriptions.select(document, [head, angle]), ['head', 'angle']);
  });

  it('are made anew after each revision of the document, which ends them', () => {
    const subscriptions = new Subscriptions();
    subscriptions.select(revision(), [angle]);
    assert.deepEqual(subscriptions.select(revision(), [makeSignal('angle', 60)]), ['angle']);
    assert.equal(subscriptions.layoutOf(2)?.width, 60);
  });

  it('explain messages that were on their way when the selection changed', () => {
    const subscriptions = new Subscriptions();
    const document = revision();
    subscriptions.select(document, [angle]);
    subscriptions.select(document, [angle, head]);
    assert.equal(subscriptions.layoutOf(1)?.width, 5);
    assert.equal(subscriptions.layoutOf(2)?.width, 12);
    assert.equal(subscriptions.layoutOf(1), null, 'no message of an earlier subscription can follow');
  });
});
