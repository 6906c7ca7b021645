import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { Connection, type ConnectionStatus } from '../../../../host/page/source/wire/connection.js';
import type { ResultMessage } from '../../../../host/page/source/wire/messages.js';
import { SocketEnd } from '../support/fake_socket.js';
import { SteadyClock } from '../support/steady_clock.js';

function setUp(wantsControl = true) {
  const clock = new SteadyClock();
  const sockets: SocketEnd[] = [];
  const statuses: ConnectionStatus[] = [];
  const results: [number, ResultMessage][] = [];
  const latencies: number[] = [];
  const connection = new Connection(
    'secret',
    'Firefox on desk-3',
    {
      openSocket: (events) => {
        const socket = new SocketEnd(events);
        sockets.push(socket);
        return socket;
      },
      now: () => clock.time,
      after: (ms, action) => clock.after(ms, action),
    },
    {
      status: (status) => statuses.push(status),
      message: () => {},
      telemetry: () => {},
      result: (key, result) => results.push([key, result]),
      latency: (ms) => latencies.push(ms),
    },
    wantsControl,
  );
  const last = () => sockets[sockets.length - 1] as SocketEnd;
  const greet = () => {
    last().events.opened();
    last().answer({ type: 'welcome', protocol: 1, client: 3, program: 'proleg 0.1.0', next_notice: 7 });
  };
  const give = (client: number | null) =>
    last().answer({
      type: 'document',
      name: 'control',
      revision: 1,
      value: { epoch: 4, holder: client === null ? null : { client, name: 'x' }, away: false, request: null },
    });
  return { clock, connection, sockets, statuses, results, latencies, last, greet, give };
}

describe('a connection', () => {
  it('says hello with protocol, token and name, and asks for control', () => {
    const { connection, last } = setUp();
    connection.open();
    last().events.opened();
    const hello = { type: 'hello', protocol: 1, token: 'secret', name: 'Firefox on desk-3', wants_control: true };
    assert.deepEqual(last().sent, [hello]);
  });

  it('that only looks does not ask for control', () => {
    const { connection, last } = setUp(false);
    connection.open();
    last().events.opened();
    assert.deepEqual(last().sent, [{ type: 'hello', protocol: 1, token: 'secret', name: 'Firefox on desk-3' }]);
  });

  it('is open after the welcome', () => {
    const { connection, statuses, greet } = setUp();
    connection.open();
    greet();
    assert.deepEqual(statuses, [{ state: 'open', client: 3, program: 'proleg 0.1.0', nextNotice: 7 }]);
  });

  it('gives operations ascending ids and hands each answer to its caller', () => {
    const { connection, results, last, greet } = setUp();
    connection.open();
    greet();
    assert.equal(connection.operate({ key: 71, epoch: 4, name: 'run', arguments: {} }), true);
    assert.equal(connection.operate({ key: 72, epoch: 4, name: 'step', arguments: { ticks: 5 } }), true);
    const [run, step] = last().ofType('operation').filter((message) => message['name'] !== 'ping');
    assert.ok((run?.['id'] as number) < (step?.['id'] as number));
    assert.deepEqual(step?.['arguments'], { ticks: 5 });
    assert.equal(step?.['epoch'], 4);
    last().answer({ type: 'result', id: step?.['id'], ok: true, value: { tick: 9 } });
    assert.equal(results.length, 1);
    assert.equal(results[0]?.[0], 72);
    assert.deepEqual(results[0]?.[1].value, { tick: 9 });
  });

  it('refuses operations before the welcome', () => {
    const { connection, last } = setUp();
    connection.open();
    assert.equal(connection.operate({ key: 1, epoch: 0, name: 'run', arguments: {} }), false);
    assert.deepEqual(last().sent, []);
  });

  it('answers operations in flight with an error when it is lost', () => {
    const { connection, results, last, greet } = setUp();
    connection.open();
    greet();
    connection.operate({ key: 9, epoch: 0, name: 'run', arguments: {} });
    last().events.closed(1006, '');
    assert.equal(results[0]?.[0], 9);
    assert.equal(results[0]?.[1].ok, false);
  });

  it('tries again after a loss, ever more slowly, up to every 4 s', () => {
    const { clock, connection, sockets, statuses, last } = setUp();
    connection.open();
    const times: number[] = [];
    for (let i = 0; i < 7; i += 1) {
      last().events.closed(1006, '');
      const count = sockets.length;
      const lost = clock.time;
      while (sockets.length === count) {
        clock.advance(50);
      }
      times.push(clock.time - lost);
    }
    assert.deepEqual(times, [250, 500, 1000, 2000, 4000, 4000, 4000]);
    assert.deepEqual(statuses.at(-1), { state: 'lost', attempts: 7 });
  });

  it('says that the program ended if it closed the connection so', () => {
    const { clock, connection, sockets, statuses, last, greet } = setUp();
    connection.open();
    greet();
    last().events.closed(1001, 'proleg ui ends');
    assert.deepEqual(statuses.at(-1), { state: 'ended' });
    clock.advance(1000);
    assert.equal(sockets.length, 2, 'it may start again');
    last().events.closed(1006, '');
    assert.deepEqual(statuses.at(-1), { state: 'ended' }, 'still');
    clock.advance(1000);
    greet();
    last().events.closed(1006, '');
    assert.deepEqual(statuses.at(-1), { state: 'lost', attempts: 1 });
  });

  it('does not try again with a token that was refused', () => {
    const { clock, connection, sockets, statuses, last } = setUp();
    connection.open();
    last().events.opened();
    last().events.closed(1008, 'wrong token');
    clock.advance(60000);
    assert.equal(sockets.length, 1);
    assert.deepEqual(statuses, [{ state: 'refused', reason: 'wrong token' }]);
  });

  it('is lost if nothing comes for more than 4 s, although the socket is open', () => {
    const { clock, connection, sockets, statuses, greet } = setUp();
    connection.open();
    greet();
    clock.advance(6000);
    assert.equal(statuses.at(1)?.state, 'lost');
    assert.equal(sockets[0]?.isClosed, true);
    assert.equal(sockets.length, 2);
  });

  it('ignores what an earlier socket still says', () => {
    const { clock, connection, sockets, statuses, last, greet } = setUp();
    connection.open();
    greet();
    last().events.closed(1006, '');
    clock.advance(250);
    greet();
    sockets[0]?.events.closed(1006, '');
    assert.equal(statuses.at(-1)?.state, 'open');
    assert.equal(sockets.length, 2);
  });

  it('measures the time to the session and back', () => {
    const { clock, connection, latencies, last, greet } = setUp();
    connection.open();
    greet();
    const ping = last().ofType('operation')[0];
    assert.equal(ping?.['name'], 'ping');
    clock.advance(12);
    last().answer({ type: 'result', id: ping?.['id'], ok: true, value: {} });
    assert.deepEqual(latencies, [12]);
  });
});

describe('signs of life', () => {
  it('are sent at least every 250 ms by the holder only', () => {
    const { clock, connection, last, greet, give } = setUp();
    connection.open();
    greet();
    const answerPings = () => last().answer({ type: 'notice', level: 'info', text: '' });
    clock.advance(2000);
    assert.equal(last().ofType('beat').length, 0);
    give(3);
    assert.equal(last().ofType('beat').length, 1, 'at once: the lease begins');
    for (let i = 0; i < 4; i += 1) {
      clock.advance(250);
      answerPings();
      assert.ok(last().ofType('beat').length >= i + 2);
    }
    give(5);
    const count = last().ofType('beat').length;
    clock.advance(2000);
    assert.equal(last().ofType('beat').length, count);
  });

  it('say since when the main thread has not answered', () => {
    const { clock, connection, last, greet, give } = setUp();
    connection.open();
    greet();
    give(3);
    clock.advance(300);
    const before = last().ofType('beat').length;
    connection.noteSignOfLife();
    clock.advance(1500);
    const ages = last().ofType('beat').slice(before).map((beat) => beat['age_ms'] as number);
    assert.ok(Math.max(...ages) >= 1200, `found ages ${ages.join()}`);
    assert.ok(ages.every((age, i) => i < 1 || age > (ages[i - 1] as number)), `found ages ${ages.join()}`);
  });
});
