import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { PageState } from '../../../../host/page/source/state/page_state.js';

function connected(): PageState {
  const state = new PageState();
  state.receiveStatus({ state: 'open', client: 3, program: 'proleg', nextNotice: 0 });
  return state;
}

const control = (client: number | null) =>
  ({
    type: 'document',
    name: 'control',
    revision: 1,
    value: { epoch: 1, holder: client === null ? null : { client, name: `viewer ${client}` }, away: false, request: null },
  }) as const;

describe('the state of the page', () => {
  it('says who drives', () => {
    const state = connected();
    state.receive(control(3));
    assert.equal(state.isHolder.value, true);
    assert.equal(state.otherHolder.value, null);
    state.receive(control(5));
    assert.equal(state.isHolder.value, false);
    assert.equal(state.otherHolder.value, 'viewer 5');
    state.receive(control(null));
    assert.equal(state.otherHolder.value, null);
  });

  it('knows when the program is another one than before', () => {
    const state = connected();
    state.receiveStatus({ state: 'lost', attempts: 1 });
    assert.equal(state.isOtherProgram.value, false);
    state.receiveStatus({ state: 'open', client: 4, program: 'proleg', nextNotice: 0 });
    assert.equal(state.isOtherProgram.value, false);
    state.receiveStatus({ state: 'open', client: 5, program: 'proleg, a later version', nextNotice: 0 });
    assert.equal(state.isOtherProgram.value, true);
  });

  it('keeps the documents when the connection is lost, but not the control', () => {
    const state = connected();
    state.receive(control(3));
    state.receive({
      type: 'document',
      name: 'telemetry',
      revision: 1,
      value: { hash: 1, tick_us: 10000, signals: [] },
    });
    state.receiveStatus({ state: 'lost', attempts: 1 });
    assert.equal(state.isHolder.value, false);
    assert.equal(state.telemetry.value?.tick_us, 10000);
  });

  it('keeps the objects of parameters that are as before, so that only the others are drawn', () => {
    const state = connected();
    const parameter = (name: string, wanted: number) =>
      ({
        slot: 1, name, unit: '', scale: 1, help: '', internal: false, wraps: false, joints: [0],
        minimum: 0, maximum: 9, default: 0, file: [0], wanted: [wanted], confirmed: [0], tick: [0],
      }) as const;
    const receive = (amplitude: number, frequency: number) =>
      state.receive(
        structuredClone({
          type: 'document',
          name: 'parameters',
          revision: 1,
          value: [parameter('amplitude', amplitude), parameter('frequency', frequency)],
        } as unknown as Parameters<PageState['receive']>[0]),
      );
    receive(1, 2);
    const before = state.parameters.value;
    receive(1, 3);
    assert.equal(state.parameters.value[0], before[0]);
    assert.notEqual(state.parameters.value[1], before[1]);
    assert.deepEqual(state.parameters.value[1]?.wanted, [3]);
  });

  it('numbers notices, and keeps the last 200', () => {
    const state = connected();
    for (let i = 0; i < 250; i += 1) {
      state.receive({ type: 'notice', level: 'info', text: `line ${i}` });
    }
    assert.equal(state.notices.value.length, 200);
    assert.deepEqual(state.notices.value.at(-1), { number: 250, level: 'info', text: 'line 249', isForAll: false });
  });

  const texts = (state: PageState) => state.notices.value.map((notice) => notice.text);
  const notice = (number: number) => ({ type: 'notice', number, level: 'info', text: `notice ${number}` }) as const;

  it('shows no notice of the time before the page', () => {
    const state = new PageState();
    state.receiveStatus({ state: 'open', client: 3, program: 'proleg', nextNotice: 2 });
    [0, 1, 2].forEach((number) => state.receive(notice(number)));
    assert.deepEqual(texts(state), ['notice 2']);
    state.receive({ type: 'notice', level: 'error', text: 'for this viewer' });
    assert.deepEqual(texts(state), ['notice 2', 'for this viewer']);
  });

  it('shows after a lost connection what it has missed, and nothing twice', () => {
    const state = connected();
    state.receive(notice(0));
    state.receiveStatus({ state: 'lost', attempts: 1 });
    state.receiveStatus({ state: 'open', client: 4, program: 'proleg', nextNotice: 2 });
    [0, 1, 2].forEach((number) => state.receive(notice(number)));
    assert.deepEqual(texts(state), ['notice 0', 'notice 1', 'notice 2']);
    // The program was started again: its notices count from 0.
    state.receiveStatus({ state: 'open', client: 1, program: 'proleg', nextNotice: 1 });
    [0, 1].forEach((number) => state.receive(notice(number)));
    assert.deepEqual(texts(state).slice(3), ['notice 1']);
  });

  it('has no problem of an earlier run', () => {
    const state = connected();
    state.receive({ type: 'notice', number: 0, level: 'error', text: 'the robot has fallen' });
    state.receive({ type: 'notice', number: 1, level: 'info', text: 'recorded 5 s in run.proleg' });
    state.forgetProblems();
    assert.deepEqual(texts(state), ['recorded 5 s in run.proleg']);
  });

  it('keeps notices about the live robot back while it is not in front, except errors', () => {
    const state = connected();
    state.receive({ type: 'notice', number: 0, level: 'warning', text: 'stopped by another viewer' });
    state.receive({ type: 'notice', number: 1, level: 'error', text: 'the robot has fallen' });
    state.receive({ type: 'notice', level: 'info', text: 'for this viewer' });
    state.addNotice('warning', 'of the page');
    const textsFor = (isLiveInFront: boolean) => state.noticesFor(isLiveInFront).map((shown) => shown.text);
    assert.deepEqual(textsFor(false), ['the robot has fallen', 'for this viewer', 'of the page']);
    assert.deepEqual(textsFor(true), ['stopped by another viewer', 'the robot has fallen', 'for this viewer', 'of the page']);
  });
});
