import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { describeConnection } from '../../../../host/page/source/panels/connection_band.js';

describe('the line about a connection', () => {
  it('says what to do to who has started the program', () => {
    assert.match(describeConnection({ state: 'ended' }, false) ?? '', /Start it again with “proleg ui”/);
    assert.match(describeConnection({ state: 'refused', reason: 'wrong token' }, false) ?? '', /\(wrong token\)\. Open the address/);
  });

  it('does not send a learner to a program that only the teacher has', () => {
    for (const state of [{ state: 'ended' }, { state: 'refused', reason: 'wrong token' }] as const) {
      assert.match(describeConnection(state, true) ?? '', /your teacher/i);
      assert.doesNotMatch(describeConnection(state, true) ?? '', /proleg ui/);
    }
  });

  it('is not there while all is well', () => {
    const open = { state: 'open', client: 1, program: 'proleg', nextNotice: 0 } as const;
    assert.equal(describeConnection(open, false), null);
    assert.equal(describeConnection(open, true), null);
  });
});
