import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { OperationQueue, OperationRefused } from '../../../../host/page/source/state/operations.js';
import { PageState } from '../../../../host/page/source/state/page_state.js';
import type { OperationRequest } from '../../../../host/page/source/wire/connection.js';

function setUp() {
  const state = new PageState();
  const sent: OperationRequest[] = [];
  return { state, sent, operations: new OperationQueue(state, (request) => sent.push(request)) };
}

describe('operations', () => {
  it('have the epoch of the lease', () => {
    const { state, sent, operations } = setUp();
    state.receive({
      type: 'document',
      name: 'control',
      revision: 1,
      value: { epoch: 17, holder: null, away: false, request: null },
    });
    void operations.ask('step', { ticks: 3 });
    assert.deepEqual(sent, [{ key: 1, epoch: 17, name: 'step', arguments: { ticks: 3 } }]);
  });

  it('get their own answers, in any order', async () => {
    const { operations } = setUp();
    const first = operations.ask('run', {});
    const second = operations.ask('pause', {});
    operations.receive(2, { type: 'result', id: 9, ok: true, value: 'b' });
    operations.receive(1, { type: 'result', id: 8, ok: true, value: 'a' });
    assert.deepEqual([await first, await second], ['a', 'b']);
  });

  it('fail with the reason of the program', async () => {
    const { operations } = setUp();
    const asked = operations.ask('run', {});
    operations.receive(1, { type: 'result', id: 1, ok: false, error: 'control is with Firefox on desk-3' });
    await assert.rejects(asked, (error) => error instanceof OperationRefused && error.message === 'control is with Firefox on desk-3');
  });

  it('become a notice when told and refused', async () => {
    const { state, operations } = setUp();
    const told = operations.tell('run', {});
    operations.receive(1, { type: 'result', id: 1, ok: false, error: 'nobody has control' });
    assert.equal(await told, null);
    assert.equal(state.notices.value[0]?.text, 'nobody has control');
  });
});
