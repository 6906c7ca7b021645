import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { SetQueue } from '../../../../host/page/source/state/set_queue.js';

function setUp() {
  const sent: { words: string[]; gesture: number; finish(): void; refuse(reason: string): void }[] = [];
  const refusals: string[] = [];
  const resets: { names: string[]; after: number }[] = [];
  const queue = new SetQueue({
    send: (words, gesture) =>
      new Promise((resolve, reject) => {
        sent.push({ words, gesture, finish: () => resolve(null), refuse: (reason) => reject(new Error(reason)) });
      }),
    reset: (names) => {
      resets.push({ names, after: sent.length });
      return Promise.resolve();
    },
    refused: (reason) => refusals.push(reason),
  });
  const settle = () => new Promise((resolve) => setImmediate(resolve));
  return { queue, sent, refusals, resets, settle };
}

describe('the queue of changes', () => {
  it('sends the first value at once', () => {
    const { queue, sent } = setUp();
    queue.set(['1.amplitude=30'], 1);
    assert.deepEqual(sent[0]?.words, ['1.amplitude=30']);
  });

  it('has one change on its way, and sends the last value after it', async () => {
    const { queue, sent, settle } = setUp();
    for (let value = 0; value <= 50; value += 1) {
      queue.set([`1.amplitude=${value}`], 1);
    }
    assert.equal(sent.length, 1);
    sent[0]?.finish();
    await settle();
    assert.deepEqual(sent.map(({ words }) => words), [['1.amplitude=0'], ['1.amplitude=50']]);
  });

  it('keeps the order of a value for all joints and one for a single joint', async () => {
    const { queue, sent, settle } = setUp();
    queue.set(['1.phase=0'], 1);
    queue.set(['1.amplitude=10', '1.amplitude:J2=20'], 1);
    queue.set(['1.amplitude=30'], 1);
    sent[0]?.finish();
    await settle();
    assert.deepEqual(sent[1]?.words, ['1.amplitude:J2=20', '1.amplitude=30']);
  });

  it('does not mix gestures, which are undone one by one', async () => {
    const { queue, sent, settle } = setUp();
    queue.set(['1.amplitude=1'], 1);
    queue.set(['1.amplitude=2'], 2);
    queue.set(['1.amplitude=3'], 3);
    sent[0]?.finish();
    await settle();
    sent[1]?.finish();
    await settle();
    assert.deepEqual(sent.map(({ gesture }) => gesture), [1, 2, 3]);
  });

  it('resets after what was set before, and sets after that what is set later', async () => {
    const { queue, sent, resets, settle } = setUp();
    queue.set(['1.amplitude=1'], 1);
    queue.set(['1.amplitude=2'], 1);
    queue.reset(['1.amplitude']);
    queue.set(['1.amplitude=3'], 1);
    sent[0]?.finish();
    await settle();
    sent[1]?.finish();
    await settle();
    assert.deepEqual(resets, [{ names: ['1.amplitude'], after: 2 }]);
    assert.deepEqual(sent.map(({ words }) => words), [['1.amplitude=1'], ['1.amplitude=2'], ['1.amplitude=3']]);
  });

  it('goes on after a refusal, which it reports', async () => {
    const { queue, sent, refusals, settle } = setUp();
    queue.set(['1.amplitude=1'], 1);
    queue.set(['1.amplitude=2'], 2);
    sent[0]?.refuse('control is with Firefox on desk-3');
    await settle();
    assert.deepEqual(refusals, ['control is with Firefox on desk-3']);
    assert.deepEqual(sent[1]?.words, ['1.amplitude=2']);
  });

  it('sends many words in several messages, as one change for undo', async () => {
    const { queue, sent, settle } = setUp();
    const words = Array.from({ length: 1000 }, (_, i) => `1.amplitude:J${i}=1`);
    queue.set(words, 5);
    for (let message = 0; message < 3; message += 1) {
      sent[message]?.finish();
      await settle();
    }
    assert.deepEqual(sent.flatMap((message) => message.words), words);
    assert.deepEqual(sent.map(({ gesture }) => gesture), [5, 5, 5]);
  });
});
