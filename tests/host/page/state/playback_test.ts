import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { Playback, speeds } from '../../../../host/page/source/state/playback.js';

const minute = () => new Playback(0, 5999, 100);

describe('the time of a recording', () => {
  it('goes on only while it plays, in real time', () => {
    const time = minute();
    time.advance(500);
    assert.equal(time.cursor.value, 0);
    time.toggle();
    time.advance(500);
    assert.equal(time.cursor.value, 50);
    time.toggle();
    time.advance(500);
    assert.equal(time.cursor.value, 50);
  });

  it('adds up frames that are shorter than a tick', () => {
    const time = minute();
    time.speed.value = 0.1;
    time.toggle();
    for (let frame = 0; frame < 60; frame += 1) {
      time.advance(1000 / 60);
    }
    assert.ok(Math.abs(time.cursor.value - 10) <= 1, `${time.cursor.value}`);
  });

  it('has speeds from 0.1 to 10, one step at a time', () => {
    const time = minute();
    speeds.forEach(() => time.faster());
    assert.equal(time.speed.value, 10);
    time.slower();
    assert.equal(time.speed.value, 5);
    speeds.forEach(() => time.slower());
    assert.equal(time.speed.value, 0.1);
  });

  it('stops at the last tick, and plays from the first again', () => {
    const time = minute();
    time.seek(5990);
    time.toggle();
    time.advance(1000);
    assert.deepEqual([time.cursor.value, time.isPlaying.value], [5999, false]);
    time.toggle();
    assert.deepEqual([time.cursor.value, time.isPlaying.value], [0, true]);
  });

  it('stops for a step, and stays in the recording', () => {
    const time = new Playback(100, 200, 100);
    time.toggle();
    time.step(1);
    assert.deepEqual([time.cursor.value, time.isPlaying.value], [101, false]);
    time.step(-100);
    assert.equal(time.cursor.value, 100);
    time.step(1000);
    assert.equal(time.cursor.value, 200);
  });

  it('moves when the pointer is pressed, not when it passes', () => {
    const time = minute();
    time.hover();
    assert.equal(time.cursor.value, 0);
    time.pick(1234.4);
    time.leave();
    assert.equal(time.shownTick(), 1234);
  });

  it('shows the whole run, or a part that goes with the cursor', () => {
    const time = minute();
    assert.deepEqual(time.range(), { from: 0, to: 5999 });
    time.detach({ from: 1000, to: 2000 });
    time.seek(2500);
    assert.deepEqual(time.range(), { from: 1500, to: 2500 });
    time.zoom(100, 2000);
    assert.equal(time.part.value, null);
  });
});
