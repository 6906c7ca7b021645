import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { currentLimitOf, currentState, moduleState, troublesOf } from '../../../../host/page/source/state/module_text.js';
import { describeGait } from '../../../../host/page/source/state/gait_text.js';
import type { BusDocument, BusModule } from '../../../../host/page/source/wire/messages.js';

const healthy: BusModule = {
  node: 3,
  joint: 2,
  state: 'Operational',
  drive: 'operation enabled',
  angle: 1,
  current: 300,
  current_limit: 2000,
  temperature: 30,
  fault: null,
  advice: null,
  silent: false,
  stop_confirmed: true,
};

const busOf = (...modules: BusModule[]): BusDocument => ({
  address: 'can0',
  connected: true,
  problem: null,
  load: 0.1,
  syncs: 100,
  other_host: false,
  latency_ms: 2,
  modules,
});

describe('a module in words', () => {
  it('is what its drive reports', () => {
    assert.deepEqual(moduleState(healthy), { text: 'operation enabled', tone: 'good' });
    assert.deepEqual(moduleState({ ...healthy, drive: null }), { text: 'Operational', tone: 'quiet' });
  });

  it('is its trouble first: silence, a fault, a STOP that it has not confirmed', () => {
    const troubled = { ...healthy, silent: true, fault: 'over-current', stop_confirmed: false };
    assert.deepEqual(moduleState(troubled), { text: 'silent', tone: 'bad' });
    assert.deepEqual(moduleState({ ...troubled, silent: false }), { text: 'over-current', tone: 'bad' });
    assert.deepEqual(moduleState({ ...healthy, stop_confirmed: false }), { text: 'STOP not confirmed', tone: 'bad' });
  });

  it('is listed with what to do, by the name of its joint or by its node', () => {
    const robot = { joints: ['J1', 'J2', 'J3'].map((name) => ({ name })) } as Parameters<typeof troublesOf>[1];
    const faulty = { ...healthy, fault: 'over-current', advice: 'Free the joint.' };
    const foreign = { ...healthy, node: 17, joint: null, silent: true };
    const troubles = troublesOf(busOf(healthy, faulty, foreign), robot);
    assert.deepEqual(troubles.map(({ text }) => text), ['J3: over-current', 'node 17: silent']);
    assert.equal(troubles[0]?.advice, 'Free the joint.');
    assert.match(troubles[1]?.advice ?? '', /power.*cable/);
  });
});

describe('the current of a servo', () => {
  it('is marked by a word and a tone near its limit, and above it', () => {
    assert.deepEqual(currentState(1599, 2000), { text: '1599', tone: '' });
    assert.deepEqual(currentState(1600, 2000), { text: '1600 near limit', tone: 'near-limit' });
    assert.deepEqual(currentState(2000, 2000), { text: '2000 near limit', tone: 'near-limit' });
    assert.deepEqual(currentState(2001, 2000), { text: '2001 above limit', tone: 'above-limit' });
  });

  it('is a number alone without a limit, or while none is known', () => {
    assert.deepEqual(currentState(9000, 0), { text: '9000', tone: '' });
    assert.deepEqual(currentState(9000, null), { text: '9000', tone: '' });
    assert.deepEqual(currentState(null, 2000), { text: '–', tone: '' });
  });

  it('has the limit of the module of its joint', () => {
    assert.equal(currentLimitOf(busOf({ ...healthy, joint: 1, current_limit: 500 }, healthy), 2), 2000);
    assert.equal(currentLimitOf(busOf(healthy), 0), null);
    assert.equal(currentLimitOf(null, 2), null);
  });
});

describe('the comparison with the gait in words', () => {
  const gait = { compared: 5000, differences: 0, missing: 2, first_difference: null, end: null };

  it('counts, and is good without a difference', () => {
    assert.deepEqual(describeGait(gait), { text: '5,000 compared, 0 differences, 2 missing', tone: 'good' });
  });

  it('is bad with a difference, or if nothing came', () => {
    assert.equal(describeGait({ ...gait, differences: 1 }).tone, 'bad');
    assert.equal(describeGait({ ...gait, compared: 0 }).tone, 'bad');
  });

  it('says that there was no run', () => {
    assert.equal(describeGait(null).tone, 'quiet');
  });
});
