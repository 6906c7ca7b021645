import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { PageState } from '../../../../host/page/source/state/page_state.js';

function connected(): PageState {
  const state = new PageState();
  state.receiveStatus({ state: 'open', client: 3, program: 'proleg' });
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
    assert.deepEqual(state.notices.value.at(-1), { number: 250, level: 'info', text: 'line 249' });
  });

  it('does not show notices twice after a new welcome, which repeats them', () => {
    const state = connected();
    state.receive({ type: 'notice', level: 'info', text: 'once' });
    state.receiveStatus({ state: 'open', client: 4, program: 'proleg' });
    assert.equal(state.notices.value.length, 0);
  });
});
