import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { describeStop, isConfirmed } from '../../../../host/page/source/state/stop_report.js';

describe('the report of STOP', () => {
  it('says how long it took and how many confirmed', () => {
    const outcome = { ms: 12.3, confirmed: 5, of: 5 };
    assert.equal(describeStop({ state: 'stopped', outcome }), 'stopped in 12 ms, 5 of 5 confirmed');
  });

  it('says what the numbers count if they are not of the modules', () => {
    assert.equal(describeStop({ state: 'stopped', outcome: { ms: 12, confirmed: 3, of: 3 } }, ' robots'), 'stopped in 12 ms, 3 of 3 robots confirmed');
  });

  it('sends to the power switch if a module has not confirmed', () => {
    const report = { state: 'stopped', outcome: { ms: 500, confirmed: 4, of: 5 } } as const;
    assert.equal(isConfirmed(report), false);
    assert.equal(describeStop(report), 'stopped in 500 ms, 4 of 5 confirmed. Use the power switch.');
  });

  it('has no numbers of modules after a POST', () => {
    assert.equal(describeStop({ state: 'stopped', outcome: { ms: 180, confirmed: null, of: null } }), 'stopped in 180 ms');
  });

  it('sends to the power switch if nothing confirmed', () => {
    assert.match(describeStop({ state: 'unconfirmed', reason: 'no answer' }), /not confirmed: no answer\. Use the power switch/);
  });
});
