import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { TimeMarks } from '../../../../host/page/source/state/time_marks.js';
import { TimeView } from '../../../../host/page/source/state/time_view.js';

const newest = 2000;

function setUp() {
  const time = new TimeView();
  const marks = new TimeMarks(time);
  const at = (tick: number) => time.showTick(tick, newest);
  return { time, marks, at };
}

describe('markers', () => {
  it('stand at the tick that is shown, in the order of time, each with a name', () => {
    const { marks, at } = setUp();
    marks.mark(newest);
    at(500);
    marks.mark(newest);
    marks.mark(newest);
    assert.deepEqual(marks.markers.value.map(({ tick, name }) => [tick, name]), [[500, 'M2'], [2000, 'M1']]);
  });

  it('can be renamed, but not to nothing', () => {
    const { marks } = setUp();
    marks.mark(newest);
    marks.rename(1, '  stumbles ');
    assert.equal(marks.markers.value[0]?.name, 'stumbles');
    marks.rename(1, '   ');
    assert.equal(marks.markers.value[0]?.name, 'stumbles');
  });

  it('are shown in the frozen view when one jumps to them', () => {
    const { time, marks, at } = setUp();
    at(300);
    marks.mark(newest);
    time.goLive();
    marks.jumpTo(1, newest);
    assert.equal(time.isLive.value, false);
    assert.equal(time.shownTick(newest), 300);
    const { from, to } = time.range(newest);
    assert.ok(from <= 300 && 300 <= to);
  });

  it('are removed one by one, and all at once by a new run', () => {
    const { marks, at } = setUp();
    for (const tick of [100, 200, 300]) {
      at(tick);
      marks.mark(newest);
    }
    marks.remove(2);
    assert.deepEqual(marks.markers.value.map(({ name }) => name), ['M1', 'M3']);
    marks.clear();
    assert.deepEqual(marks.markers.value, []);
  });
});

describe('the loop', () => {
  it('plays round between its ends', () => {
    const { time, marks, at } = setUp();
    at(400);
    marks.setLoopStart(newest);
    assert.equal(marks.isPlaying.value, false);
    at(500);
    marks.setLoopEnd(newest);
    assert.equal(marks.isPlaying.value, true);
    const shown = [30, 30.5, 30, 30, 250].map((ticks) => {
      marks.play(ticks, newest);
      return time.shownTick(newest);
    });
    assert.deepEqual(shown, [430, 460, 490, 420, 470]);
  });

  it('freezes a live view, and stands still when the view is live again', () => {
    const { time, marks } = setUp();
    marks.setLoopEnd(newest);
    assert.equal(time.isLive.value, false);
    time.showTick(1900, newest);
    marks.setLoopStart(newest);
    assert.deepEqual(marks.range.value, { from: 1900, to: 2000 });
    time.goLive();
    marks.play(50, newest);
    assert.equal(time.isLive.value, true);
    assert.equal(marks.isPlaying.value, false);
  });

  it('loses the end that is on the wrong side', () => {
    const { marks, at } = setUp();
    at(400);
    marks.setLoopStart(newest);
    at(500);
    marks.setLoopEnd(newest);
    at(600);
    marks.setLoopStart(newest);
    assert.deepEqual(marks.loop.value, { from: 600, to: null });
    at(600);
    marks.setLoopEnd(newest);
    assert.deepEqual(marks.loop.value, { from: null, to: 600 });
  });

  it('pauses, goes on from its start, and can be removed', () => {
    const { time, marks, at } = setUp();
    at(400);
    marks.setLoopStart(newest);
    at(500);
    marks.setLoopEnd(newest);
    marks.play(20, newest);
    marks.playOrPause(newest);
    marks.play(20, newest);
    assert.equal(time.shownTick(newest), 420);
    marks.playOrPause(newest);
    assert.equal(time.shownTick(newest), 400);
    marks.removeLoop();
    marks.playOrPause(newest);
    assert.equal(marks.isPlaying.value, false);
  });
});
