import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { PoseQueue } from '../../../../host/page/source/state/pose_queue.js';
import { SteadyClock } from '../support/steady_clock.js';

function setUp() {
  const clock = new SteadyClock();
  const sent: { angles: (number | null)[]; speed: number; time: number; finish(): void; refuse(reason: string): void }[] = [];
  const refusals: string[] = [];
  const queue = new PoseQueue({
    isPossible: () => true,
    send: (angles, speed) =>
      new Promise((resolve, reject) => {
        const refuse = (reason: string) => reject(new Error(reason));
        sent.push({ angles, speed, time: clock.time, finish: () => resolve(null), refuse });
      }),
    refused: (reason) => refusals.push(reason),
    after: (ms, action) => clock.after(ms, action),
  });
  const settle = () => new Promise((resolve) => setImmediate(resolve));
  return { clock, queue, sent, refusals, settle };
}

describe('the queue of positions', () => {
  it('sends a joint at once, the others nowhere, at the chosen speed', () => {
    const { queue, sent } = setUp();
    queue.speed.value = 20;
    queue.move(new Map([[1, 30]]), 3);
    assert.deepEqual(sent[0]?.angles, [null, 30, null]);
    assert.equal(sent[0]?.speed, 20);
  });

  it('sends at most 50 messages a second, the newest angle of each joint, and the last one always', async () => {
    const { clock, queue, sent, settle } = setUp();
    for (let ms = 0; ms < 1000; ms += 1) {
      queue.move(new Map([[0, ms], [ms % 2 === 0 ? 1 : 2, -ms]]), 3);
      sent.at(-1)?.finish();
      await settle();
      clock.advance(1);
      await settle();
    }
    assert.ok(sent.length > 45, `found ${sent.length} messages in a second`);
    assert.deepEqual(sent.filter(({ time }, i) => time - (sent[i - 1]?.time ?? -20) < 20), []);
    sent.at(-1)?.finish();
    await settle();
    clock.advance(20);
    await settle();
    assert.deepEqual(sent.at(-1)?.angles, [999, -998, -999]);
  });

  it('has one message on its way, however long the answer takes', async () => {
    const { clock, queue, sent, settle } = setUp();
    queue.move(new Map([[0, 1]]), 1);
    queue.move(new Map([[0, 2]]), 1);
    clock.advance(5000);
    await settle();
    assert.equal(sent.length, 1);
    sent[0]?.finish();
    await settle();
    assert.equal(sent.length, 2);
  });

  it('knows where joints were sent to, until they are forgotten', () => {
    const { queue } = setUp();
    queue.move(new Map([[0, 1]]), 2);
    queue.move(new Map([[1, 5]]), 2);
    assert.deepEqual([...queue.targets.value], [[0, 1], [1, 5]]);
    queue.forget();
    assert.equal(queue.targets.value.size, 0);
  });

  it('sends nothing of what waited when the robot is no longer held', async () => {
    const { clock, queue, sent, settle } = setUp();
    queue.move(new Map([[0, 1]]), 1);
    queue.move(new Map([[0, 2]]), 1);
    queue.forget();
    sent[0]?.finish();
    clock.advance(100);
    await settle();
    assert.equal(sent.length, 1);
  });

  it('reports a refusal, drops what waited for it, and goes on', async () => {
    const { clock, queue, sent, refusals, settle } = setUp();
    queue.move(new Map([[0, 1]]), 1);
    queue.move(new Map([[0, 2]]), 1);
    sent[0]?.refuse('the robot is not held');
    await settle();
    clock.advance(20);
    await settle();
    assert.deepEqual(refusals, ['the robot is not held']);
    assert.equal(sent.length, 1);
    queue.move(new Map([[0, 3]]), 1);
    await settle();
    assert.equal(sent.length, 2);
  });
});
