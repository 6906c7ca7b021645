// What the page asks a recording for, and what it draws of the answers. The recording is a function of the tick.
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { CursorRows } from '../../../../host/page/source/recordings/cursor_rows.js';
import { RangeRows, type AskRows } from '../../../../host/page/source/recordings/range_rows.js';
import { strideFor } from '../../../../host/page/source/recordings/recording_client.js';
import type { Signal } from '../../../../host/page/source/wire/messages.js';
import { decodeRecordedRows } from '../../../../host/page/source/wire/recorded_rows.js';
import { encodeRecordedRows } from '../support/recorded_rows.js';

const angle: Signal = { name: 'angle', unit: 'deg', scale: 1, count: 1, of: 'joint' };
const valueAt = (tick: number) => Math.round(1000 * Math.sin(tick / 50)) + (tick === 5000 ? 9999 : 0);

// As the program answers; `last` may grow, `indexed` too.
class Program {
  readonly asked: [number, number][] = [];
  last = 99999;
  indexed = 100000;

  readonly ask: AskRows = async (_, from, to) => {
    this.asked.push([from, to]);
    const end = Math.min(to, this.last);
    const stride = strideFor(end - from + 1);
    const rows: number[][] = [];
    const first = Math.floor(from / stride) * stride;
    for (let tick = first; tick <= end && (stride === 1 || tick < this.indexed); tick += stride) {
      const values = Array.from({ length: stride }, (_value, i) => valueAt(tick + i));
      rows.push(stride === 1 ? [valueAt(tick)] : [valueAt(tick), Math.min(...values), Math.max(...values)]);
    }
    return decodeRecordedRows(encodeRecordedRows({ tick: first, stride, lastTick: this.last, rows }), 1);
  };
}

const settle = () => new Promise((done) => setImmediate(done));
const unexpected = (reason: string) => assert.fail(reason);

describe('rows of a part of a recording', () => {
  it('are every tick of a short part', async () => {
    const program = new Program();
    const rows = new RangeRows(program.ask, () => 0, unexpected);
    rows.want({ from: 100.4, to: 199.5 }, [angle], 0, program.last);
    await settle();
    for (let tick = 100; tick <= 200; tick += 1) {
      assert.equal(rows.lines.valueAt('angle', 0, rows.lines.rowAtTick(tick)), valueAt(tick));
      assert.equal(rows.samples.tickOf(rows.samples.rowAtTick(tick)), tick);
    }
  });

  it('keep every peak of a long part, in the lines', async () => {
    const program = new Program();
    const rows = new RangeRows(program.ask, () => 0, unexpected);
    rows.want({ from: 0, to: program.last }, [angle], 0, program.last);
    await settle();
    const ring = rows.lines.rings.get('angle');
    assert.ok(ring);
    const { maximum, minimum } = ring.pyramid.rangeOf(0, rows.lines.first, rows.lines.end);
    assert.equal(maximum, valueAt(5000));
    assert.equal(minimum, -1000);
    // Samples are values of one tick.
    for (let row = rows.samples.first; row < rows.samples.end; row += 1) {
      assert.equal(rows.samples.valueAt('angle', 0, row), valueAt(rows.samples.tickOf(row)));
    }
  });

  it('are asked for once, and again when the part leaves them or needs finer ones', async () => {
    const program = new Program();
    const rows = new RangeRows(program.ask, () => 0, unexpected);
    const want = async (from: number, to: number) => {
      rows.want({ from, to }, [angle], 0, program.last);
      rows.want({ from, to }, [angle], 0, program.last);
      await settle();
      return program.asked.length;
    };
    assert.equal(await want(10000, 11000), 1);
    assert.equal(await want(10100, 11100), 1, 'a small move is in the margin');
    assert.equal(await want(20000, 21000), 2);
    assert.equal(await want(0, 90000), 3);
    assert.equal(await want(30000, 31000), 4, 'finer');
  });

  it('come when the pyramid has got so far', async () => {
    const program = new Program();
    program.indexed = 30000;
    let now = 0;
    const rows = new RangeRows(program.ask, () => now, unexpected);
    const want = async () => {
      rows.want({ from: 0, to: program.last }, [angle], 0, program.last);
      await settle();
    };
    await want();
    await want();
    assert.equal(program.asked.length, 1, 'not at each frame');
    program.indexed = 100000;
    now = 1000;
    await want();
    assert.equal(program.asked.length, 2);
    assert.ok(rows.samples.lastTick() > 99000);
  });

  it('say why they cannot be read, and do not ask again', async () => {
    let asked = 0;
    let reason = '';
    const ask: AskRows = () => {
      asked += 1;
      return Promise.reject(new Error('a gap in the table pose'));
    };
    const rows = new RangeRows(ask, () => 0, (why) => (reason = why));
    for (let frame = 0; frame < 5; frame += 1) {
      rows.want({ from: 0, to: 100 }, [angle], 0, 1000);
      await settle();
    }
    assert.equal(reason, 'a gap in the table pose');
    assert.equal(asked, 1);
  });
});

describe('rows about the time cursor', () => {
  it('are there after a jump, and before they are shown while it plays', async () => {
    const program = new Program();
    const rows = new CursorRows(program.ask, unexpected);
    const want = async (tick: number, isPlaying: boolean) => {
      rows.want(tick, [angle], 0, program.last, isPlaying);
      await settle();
      assert.equal(rows.history.valueAt('angle', 0, rows.history.rowAtTick(tick)), valueAt(tick));
    };
    await want(70000, false);
    await want(5, false);
    await want(program.last, false);
    const jumps = program.asked.length;
    await want(40000, false);
    for (let tick = 40000; tick < 50000; tick += 16) {
      await want(tick, true);
      assert.ok(rows.has(tick + 16), `tick ${tick + 16} is not there yet`);
    }
    assert.ok(program.asked.length - jumps < 25, `${program.asked.length} questions`);
  });
});
