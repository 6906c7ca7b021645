import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { frozenText, TimeView } from '../../../../host/page/source/state/time_view.js';

describe('the view of time', () => {
  it('ends at the newest tick when live', () => {
    const view = new TimeView();
    view.window.value = 500;
    assert.deepEqual(view.range(2000), { from: 1500, to: 2000 });
    assert.equal(view.shownTick(2000), 2000);
  });

  it('begins at tick 0 until the run fills the window', () => {
    const view = new TimeView();
    view.window.value = 500;
    assert.deepEqual(view.range(120), { from: 0, to: 500 });
    assert.equal(view.shownTick(120), 120);
  });

  it('stands still when detached, while ticks go on to come in', () => {
    const view = new TimeView();
    view.detach({ from: 100, to: 300 });
    assert.deepEqual(view.range(2000), { from: 100, to: 300 });
    assert.equal(view.isLive.value, false);
    assert.equal(view.shownTick(2000), 300);
  });

  it('returns to live without a cursor', () => {
    const view = new TimeView();
    view.freeze(1000);
    view.goLive();
    assert.equal(view.isLive.value, true);
    assert.equal(view.cursor.value, null);
  });

  it('detaches when it is zoomed, and keeps what is under the pointer in place', () => {
    const view = new TimeView();
    view.window.value = 1000;
    view.zoom(0.5, 1250, 2000);
    assert.deepEqual(view.detached.value, { from: 1125, to: 1625 });
  });

  it('never shows less than 10 ticks', () => {
    const view = new TimeView();
    view.detach({ from: 50, to: 50.1 });
    const { from, to } = view.range(100);
    assert.equal(to - from, 10);
  });

  it('shows the time under the pointer until the pointer leaves, or for good if it is frozen', () => {
    const view = new TimeView();
    view.hover(700.4);
    assert.equal(view.shownTick(1000), 700);
    view.leave();
    assert.equal(view.shownTick(1000), 1000);
    view.freeze(1000);
    view.pick(800);
    view.leave();
    assert.equal(view.shownTick(2000), 800);
  });

  it('freezes when the cursor moves, and takes the window along', () => {
    const view = new TimeView();
    view.window.value = 100;
    view.moveCursor(-1, 1000);
    assert.equal(view.cursor.value, 999);
    assert.deepEqual(view.range(5000), { from: 900, to: 1000 });
    view.moveCursor(-199, 1000);
    assert.equal(view.cursor.value, 800);
    assert.deepEqual(view.range(5000), { from: 800, to: 900 });
  });

  it('keeps the cursor between tick 0 and the newest', () => {
    const view = new TimeView();
    view.moveCursor(-5000, 1000);
    assert.equal(view.cursor.value, 0);
    view.moveCursor(5000, 1000);
    assert.equal(view.cursor.value, 1000);
  });
});

describe('a frozen view', () => {
  it('says whether the robot goes on', () => {
    for (const state of ['running', 'starting', 'stopping']) assert.match(frozenText(state), /the robot goes on/);
    for (const state of ['paused', 'stopped', 'failed', 'off', 'held', undefined]) assert.match(frozenText(state), /the robot stands still/);
  });
});
