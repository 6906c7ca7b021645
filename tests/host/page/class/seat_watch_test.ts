import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { SeatWatch } from '../../../../host/page/source/class/seat_watch.js';
import { SocketEnd } from '../support/fake_socket.js';
import { SteadyClock } from '../support/steady_clock.js';

const signals = [
  { name: 'setpoint', unit: 'degree', scale: 1, count: 2, of: 'joint' },
  { name: 'angle', unit: 'degree', scale: 0.5, count: 2, of: 'joint' },
  { name: 'head', unit: '', scale: 1, count: 7, of: 'robot' },
];

function rowsOf(subscription: number, tick: number, stride: number, rows: number[][]): ArrayBuffer {
  const width = rows[0]?.length ?? 0;
  const buffer = new ArrayBuffer(16 + 4 * width * rows.length);
  const view = new DataView(buffer);
  view.setUint32(0, subscription, true);
  view.setUint32(4, tick, true);
  view.setUint16(8, rows.length, true);
  view.setUint16(10, stride, true);
  view.setUint16(12, 5, true);
  rows.flat().forEach((value, i) => view.setInt32(16 + 4 * i, value, true));
  return buffer;
}

function setUp() {
  const clock = new SteadyClock();
  const sockets: SocketEnd[] = [];
  const watch = new SeatWatch(
    { seat: 3, url: 'ws://x/robots/3/socket?look', token: 'secret' },
    {
      openSocket: (events) => {
        const socket = new SocketEnd(events);
        sockets.push(socket);
        return socket;
      },
      now: () => clock.time,
      after: (ms, action) => clock.after(ms, action),
    },
  );
  const last = () => sockets.at(-1) as SocketEnd;
  const greet = () => {
    last().events.opened();
    last().answer({ type: 'welcome', protocol: 1, client: 3, program: 'proleg', next_notice: 0 });
    last().answer({ type: 'document', name: 'telemetry', revision: 1, value: { hash: 9, tick_us: 10000, signals } });
  };
  return { clock, sockets, watch, last, greet };
}

const still = [1_000_000, 2_000_000, 0, 2 ** 30, 0, 0, 0]; // head
const halfTurn = Math.PI;

describe('a robot that a teacher watches', () => {
  it('is looked at without asking for control', () => {
    const { watch, last, greet } = setUp();
    greet();
    assert.deepEqual(last().ofType('hello'), [{ type: 'hello', protocol: 1, token: 'secret', name: 'Teacher' }]);
    assert.deepEqual(watch.takeNews(), { seat: 3, isConnected: true });
    assert.equal(watch.takeNews(), null);
  });

  it('sends a row for each look, and rests between them', () => {
    const { watch, last, greet } = setUp();
    greet();
    watch.takeNews();
    watch.look();
    watch.look();
    assert.deepEqual(last().ofType('subscribe'), [{ type: 'subscribe', signals: ['angle', 'head'], hash: 9, newest: true }]);
    last().events.binary(rowsOf(1, 40, 2, [[0, 0, ...still], [360, -360, ...still]]));
    assert.deepEqual(watch.takeNews(), { seat: 3, row: { run: 5, tick: 42, angles: [halfTurn, -halfTurn], head: [1, 2, 0, 1, 0, 0, 0] } });
    assert.deepEqual(last().ofType('subscribe').at(-1), { type: 'subscribe', signals: [], hash: 9, newest: false });
    last().events.binary(rowsOf(1, 44, 1, [[0, 0, ...still]]));
    assert.equal(watch.takeNews(), null, 'what was on its way');
    watch.look();
    last().events.binary(rowsOf(3, 50, 1, [[0, 0, ...still]]));
    assert.equal(watch.takeNews()?.row?.tick, 50);
  });

  it('sends nothing while the page is hidden', () => {
    const { watch, last, greet } = setUp();
    greet();
    watch.rest();
    assert.deepEqual(last().ofType('subscribe'), []);
    watch.look();
    watch.rest();
    assert.deepEqual(last().ofType('subscribe').map((message) => message['signals']), [['angle', 'head'], []]);
  });

  it('is looked at again when its signals are others, and after the connection was lost', () => {
    const { clock, watch, last, greet } = setUp();
    greet();
    watch.look();
    last().answer({ type: 'document', name: 'telemetry', revision: 2, value: { hash: 10, tick_us: 10000, signals: signals.slice(1) } });
    watch.look();
    assert.equal(last().ofType('subscribe').at(-1)?.['hash'], 10);
    last().events.closed(1006, '');
    assert.equal(watch.takeNews()?.isConnected, false);
    clock.advance(300);
    greet();
    watch.look();
    last().events.binary(rowsOf(1, 7, 1, [[0, 0, ...still]]));
    assert.equal(watch.takeNews()?.row?.tick, 7);
  });

  it('says how it is: speed only while it runs', () => {
    const { watch, last, greet } = setUp();
    greet();
    const value = { state: 'running', recent_speed: 0.05, measures: { distance: 0.5 }, servo_problem: null, failure: null, recording: null };
    last().answer({ type: 'document', name: 'session', revision: 3, value });
    assert.deepEqual(watch.takeNews()?.session, { state: 'running', speed: 0.05, distance: 0.5, servoProblem: null, failure: null, isRecording: false });
    last().answer({ type: 'document', name: 'session', revision: 4, value: { ...value, state: 'stopped', recording: 'run.proleg' } });
    assert.deepEqual(watch.takeNews()?.session, { state: 'stopped', speed: null, distance: 0.5, servoProblem: null, failure: null, isRecording: true });
  });

  it('is let alone when it is closed, also while a new attempt is planned', () => {
    const { clock, sockets, watch, last } = setUp();
    last().events.closed(1006, '');
    watch.close();
    clock.advance(10_000);
    assert.equal(sockets.length, 1);
    const other = setUp();
    other.greet();
    other.watch.close();
    assert.equal(other.last().isClosed, true);
    other.last().events.closed(1000, '');
    other.clock.advance(10_000);
    assert.equal(other.sockets.length, 1);
  });
});
