import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { StopChannel } from '../../../../host/page/source/wire/stop_channel.js';
import { SocketEnd } from '../support/fake_socket.js';
import { SteadyClock } from '../support/steady_clock.js';

function setUp(post: () => Promise<void>) {
  const clock = new SteadyClock();
  const sockets: SocketEnd[] = [];
  let posts = 0;
  const channel = new StopChannel('secret', 'STOP of desk-3', {
    openSocket: (events) => {
      const socket = new SocketEnd(events);
      sockets.push(socket);
      return socket;
    },
    post: () => {
      posts += 1;
      return post();
    },
    now: () => clock.time,
    after: (ms, action) => clock.after(ms, action),
  });
  channel.open();
  return { clock, channel, sockets, first: sockets[0] as SocketEnd, posts: () => posts };
}

const never = () => new Promise<void>(() => {});

describe('STOP', () => {
  it('goes over its socket, and not by POST if that answers', async () => {
    const { clock, channel, first, posts } = setUp(never);
    first.events.opened();
    const outcome = channel.press();
    assert.equal(first.ofType('stop').length, 1);
    clock.advance(12);
    first.answer({ type: 'stopped', confirmed: 5, of: 5, ms: 3.1 });
    assert.deepEqual(await outcome, { ms: 12, confirmed: 5, of: 5 });
    clock.advance(1000);
    assert.equal(posts(), 0);
  });

  it('does not wait for a welcome', () => {
    const { channel, first } = setUp(never);
    first.events.opened();
    void channel.press();
    assert.deepEqual(first.sent.map((message) => message['type']), ['hello', 'stop']);
    assert.equal(first.sent[0]?.['only'], 'stop');
  });

  it('goes by POST at once if the socket is not open', async () => {
    const { channel, posts } = setUp(() => Promise.resolve());
    const outcome = await channel.press();
    assert.equal(posts(), 1);
    assert.equal(outcome.confirmed, null);
  });

  it('goes by POST too if the socket does not answer within 150 ms', async () => {
    const { clock, channel, first, posts } = setUp(() => Promise.resolve());
    first.events.opened();
    const outcome = channel.press();
    clock.advance(149);
    assert.equal(posts(), 0);
    clock.advance(1);
    assert.equal(posts(), 1);
    assert.equal((await outcome).ms, 150);
  });

  it('reports the numbers that come after the answer to the POST', async () => {
    const { clock, channel, first } = setUp(() => Promise.resolve());
    first.events.opened();
    const later: unknown[] = [];
    const outcome = channel.press((numbers) => later.push(numbers));
    clock.advance(150);
    assert.equal((await outcome).confirmed, null);
    clock.advance(350);
    first.answer({ type: 'stopped', confirmed: 4, of: 5, ms: 500 });
    assert.deepEqual(later, [{ ms: 500, confirmed: 4, of: 5 }]);
  });

  it('is reported as not confirmed if both ways fail', async () => {
    const { channel } = setUp(() => Promise.reject(new Error('no answer')));
    await assert.rejects(channel.press(), /no answer/);
  });

  it('is sent again by each press', () => {
    const { channel, first } = setUp(never);
    first.events.opened();
    void channel.press();
    void channel.press();
    assert.equal(first.ofType('stop').length, 2);
  });

  it('has its socket opened again after a loss', () => {
    const { clock, channel, sockets, first } = setUp(never);
    first.events.opened();
    first.events.closed(1006, '');
    clock.advance(1000);
    assert.equal(sockets.length, 2);
    sockets[1]?.events.opened();
    void channel.press();
    assert.equal(sockets[1]?.ofType('stop').length, 1);
  });
});
