import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { rotate, type Vector } from '../../../../host/page/source/geometry/quaternion.js';
import { MoveTool, placedHead, type RobotPlace } from '../../../../host/page/source/state/move_tool.js';
import { PageState } from '../../../../host/page/source/state/page_state.js';
import type { SessionDocument } from '../../../../host/page/source/wire/messages.js';

function setUp() {
  const state = new PageState();
  const asked: RobotPlace[] = [];
  let isRefused = false;
  const tool = new MoveTool(state, (place) => {
    asked.push(place);
    return Promise.resolve(isRefused ? null : { tick: 7 });
  });
  state.receiveStatus({ state: 'open', client: 3, program: 'proleg', nextNotice: 0 });
  state.control.value = { epoch: 1, holder: { client: 3, name: 'me' }, away: false, request: null };
  const setState = (name: SessionDocument['state'], x = 1) => {
    state.session.value = { state: name, head: [x, 2, 0.5, 1, 0, 0, 0] } as unknown as SessionDocument;
  };
  setState('paused');
  tool.isOn.value = true;
  return { state, asked, tool, setState, refuse: () => (isRefused = true) };
}

describe('moving the robot', () => {
  it('asks the program once, when the robot is dropped', async () => {
    const { tool, asked } = setUp();
    tool.begin();
    tool.drag([0.1, 0, 0], 0);
    tool.drag([0.25, -1, 0], 10);
    assert.deepEqual(tool.preview.value, { position: [1.25, 1, 0.5], turn: 10 });
    assert.deepEqual(asked, []);
    await tool.drop();
    assert.deepEqual(asked, [{ position: [1.25, 1, 0.5], turn: 10 }]);
    assert.equal(tool.preview.value, null);
  });

  it('does nothing after a press without a drag', async () => {
    const { tool, asked } = setUp();
    tool.begin();
    tool.drag([0, 0, 0], 0);
    await tool.drop();
    assert.deepEqual(asked, []);
  });

  it('adds up steps that come faster than the documents of the program', async () => {
    const { tool, asked, setState } = setUp();
    const first = tool.step([0.5, 0, 0], 0);
    const second = tool.step([0.5, 0, 0], 5);
    await Promise.all([first, second]);
    await tool.step([0.5, 0, 0], 0);
    assert.deepEqual(asked.map(({ position, turn }) => [position[0], turn]), [[1.5, 0], [2, 5], [2.5, 0]]);
    assert.equal(tool.preview.value, null);
    // The document says where the robot is: it may have been lifted.
    setState('paused', 2.25);
    await tool.step([0.5, 0, 0], 0);
    assert.equal(asked.at(-1)?.position[0], 2.75);
  });

  it('begins where the robot is after a refusal', async () => {
    const { tool, asked, refuse } = setUp();
    refuse();
    await tool.step([0.5, 0, 0], 0);
    await tool.step([0, 0.5, 0], 0);
    assert.deepEqual(asked.at(-1)?.position, [1, 2.5, 0.5]);
  });

  it('is only for a paused robot, and for who has control', async () => {
    const { tool, asked, state, setState } = setUp();
    for (const name of ['running', 'stopped', 'failed'] as const) {
      setState(name);
      await tool.step([1, 0, 0], 0);
    }
    setState('paused');
    state.control.value = { epoch: 2, holder: { client: 4, name: 'other' }, away: false, request: null };
    await tool.step([1, 0, 0], 0);
    assert.deepEqual(asked, []);
    assert.equal(tool.isPossible.value, false);
  });

  it('turns to the left about the vertical', () => {
    const head = placedHead({ position: [0, 0, 0], orientation: [1, 0, 0, 0] }, { position: [1, 2, 3], turn: 90 });
    const forward = rotate(head.orientation, [0, 1, 0] as Vector);
    assert.deepEqual(head.position, [1, 2, 3]);
    [-1, 0, 0].forEach((value, axis) => assert.ok(Math.abs((forward[axis] as number) - value) < 1e-12));
  });
});
