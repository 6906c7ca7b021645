import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { ActionList, type Action, type KeyPress } from '../../../../host/page/source/state/actions.js';

const press = (key: string, fields: Partial<KeyPress> = {}): KeyPress => ({
  key,
  ctrlKey: false,
  metaKey: false,
  shiftKey: false,
  altKey: false,
  ...fields,
});
const action = (id: string, keys: string[], fields: Partial<Action> = {}): Action => ({
  id,
  title: id,
  group: 'View',
  keys,
  run: () => {},
  ...fields,
});

function listOf(...actions: Action[]): ActionList {
  const list = new ActionList();
  list.add(...actions);
  return list;
}

describe('actions', () => {
  it('are found by their key, with Caps Lock too', () => {
    const list = listOf(action('run', ['K']));
    assert.equal(list.forKey(press('k'), false)?.id, 'run');
    assert.equal(list.forKey(press('K'), false)?.id, 'run');
  });

  it('tell Shift and Ctrl apart', () => {
    const list = listOf(action('restart', ['Shift+R']), action('palette', ['Ctrl+K']), action('run', ['K']));
    assert.equal(list.forKey(press('R', { shiftKey: true }), false)?.id, 'restart');
    assert.equal(list.forKey(press('r'), false), undefined);
    assert.equal(list.forKey(press('k', { ctrlKey: true }), false)?.id, 'palette');
    assert.equal(list.forKey(press('k', { metaKey: true }), false)?.id, 'palette');
  });

  it('find a symbol whether or not the keyboard needs Shift for it', () => {
    const list = listOf(action('keys', ['?']));
    assert.equal(list.forKey(press('?', { shiftKey: true }), false)?.id, 'keys');
    assert.equal(list.forKey(press('?'), false)?.id, 'keys');
  });

  it('of a page come before those that it shares with the whole', () => {
    const whole = listOf(action('run', ['K']), action('record', ['R']), action('keys', ['?'], { group: 'Page' }));
    const page = new ActionList(whole, (shared) => shared.group === 'Page');
    page.add(action('play', ['K']));
    assert.equal(page.forKey(press('k'), false)?.id, 'play');
    assert.equal(page.forKey(press('?'), false)?.id, 'keys');
    assert.equal(page.forKey(press('r'), false), undefined);
    assert.deepEqual(page.all.map(({ id }) => id), ['play', 'keys']);
    assert.deepEqual(page.matching('').map(({ id }) => id), ['play', 'keys']);
    assert.equal(whole.forKey(press('k'), false)?.id, 'run');
  });

  it('leave text fields alone, except those that must work everywhere', () => {
    const list = listOf(action('run', ['K']), action('palette', ['Ctrl+K'], { isGlobal: true }));
    assert.equal(list.forKey(press('k'), true), undefined);
    assert.equal(list.forKey(press('k', { ctrlKey: true }), true)?.id, 'palette');
  });

  it('do not start when they are disabled, or with Alt', () => {
    const list = listOf(action('run', ['K'], { isEnabled: () => false }), action('live', ['L']));
    assert.equal(list.forKey(press('k'), false), undefined);
    assert.equal(list.forKey(press('l', { altKey: true }), false), undefined);
  });

  it('of another kind of robot are neither listed nor started', () => {
    const list = listOf(action('step', ['.'], { isShown: () => false }), action('live', ['L']));
    assert.equal(list.forKey(press('.'), false), undefined);
    assert.deepEqual(list.all.map(({ id }) => id), ['live']);
    assert.deepEqual(list.matching('').map(({ id }) => id), ['live']);
  });

  it('never share a key', () => {
    assert.throws(() => listOf(action('a', ['K']), action('b', ['K'])), /key K: found in a and b/);
  });

  it('are found by words of their titles, in any order', () => {
    const list = listOf(action('a', [], { title: 'Restart at tick 0' }), action('b', [], { title: 'Run, or pause' }));
    assert.deepEqual(list.matching('tick REST').map(({ id }) => id), ['a']);
    assert.equal(list.matching('').length, 2);
  });
});
