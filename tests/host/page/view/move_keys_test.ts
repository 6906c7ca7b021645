import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { pageSignal } from '../support/page_signal.js';
import { ActionList, type KeyPress } from '../../../../host/page/source/state/actions.js';
import { openDialog } from '../../../../host/page/source/view/dialogs.js';
import { moveActions } from '../../../../host/page/source/view/move_actions.js';
import type { PageName, Stores } from '../../../../host/page/source/view/robot_view.js';

const press = (key: string, shiftKey = false): KeyPress => ({ key, shiftKey, ctrlKey: false, metaKey: false, altKey: false });

function setUp() {
  const actions = new ActionList();
  const isActive = pageSignal(true);
  const shownPage = pageSignal<PageName>('live');
  const steps: [readonly number[], number][] = [];
  const cursor: number[] = [];
  const mover = { isActive, step: (offset: number[], turn: number) => steps.push([offset, turn]) };
  const hasCursorKeys = () => !isActive.value;
  actions.add(
    ...moveActions({ mover, shownPage } as unknown as Stores<'mover' | 'shownPage'>),
    { id: 'tick_on', title: '', group: 'View', keys: ['ArrowRight'], isShown: hasCursorKeys, run: () => cursor.push(1) },
  );
  return { actions, isActive, shownPage, steps, cursor };
}

describe('the keys of Move', () => {
  it('move the robot wherever the focus is, and not the time cursor', () => {
    const { actions, steps, cursor } = setUp();
    for (const key of ['ArrowRight', 'ArrowLeft', 'ArrowUp', 'PageDown']) {
      const action = actions.forKey(press(key), false);
      assert.equal(action?.isBeforeElements, true, key);
      action?.run();
    }
    actions.forKey(press('ArrowUp', true), false)?.run();
    assert.deepEqual(steps, [[[0.01, 0, 0], 0], [[-0.01, 0, 0], 0], [[0, 0.01, 0], 0], [[0, 0, 0], -5], [[0, 0, 0.01], 0]]);
    assert.deepEqual(cursor, []);
  });

  it('are those of a text field in one', () => {
    assert.equal(setUp().actions.forKey(press('ArrowRight'), true), undefined);
  });

  it('are those of the time cursor when Move is off', () => {
    const { actions, isActive, steps, cursor } = setUp();
    isActive.value = false;
    actions.forKey(press('ArrowRight'), false)?.run();
    assert.equal(actions.forKey(press('PageUp'), false), undefined);
    assert.deepEqual([steps, cursor], [[], [1]]);
  });

  it('move no robot on another page, or behind a dialog', () => {
    const { actions, shownPage } = setUp();
    shownPage.value = 'make';
    assert.notEqual(actions.forKey(press('ArrowRight'), false)?.isBeforeElements, true);
    shownPage.value = 'live';
    openDialog.value = 'keys';
    assert.notEqual(actions.forKey(press('PageUp'), false)?.isBeforeElements, true);
    openDialog.value = 'none';
  });
});
