import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { EntryState } from '../../../../host/page/source/class/entry_state.js';
import type { JoinAnswer, JoinWish } from '../../../../host/page/source/class/join.js';
import { KeyStore } from '../../../../host/page/source/class/key_store.js';
import { MemoryStorage } from '../support/memory_storage.js';

const joined: JoinAnswer = { seat: 3, name: 'Anna', path: '/robots/3/', token: 't', key: 'k' };
type Post = (wish: JoinWish) => Promise<{ status: number; body: string }>;

function setUp(post: Post = async () => ({ status: 200, body: JSON.stringify(joined) }), codeOfLink: string | null = null) {
  const keys = new KeyStore(new MemoryStorage());
  const pending = new KeyStore(new MemoryStorage());
  let made = 0;
  const wishes: JoinWish[] = [];
  const entered: JoinAnswer[] = [];
  const make = () =>
    new EntryState(codeOfLink, keys, pending, {
      makeKey: () => `made ${(made += 1)}`,
      post: (wish) => {
        wishes.push(wish);
        return post(wish);
      },
      enter: (answer) => void entered.push(answer),
    });
  return { keys, wishes, entered, make };
}

describe('the entry of a class', () => {
  it('takes name and code to the robot, and keeps the key for the next time', async () => {
    const { keys, wishes, entered, make } = setUp();
    const entry = make();
    entry.name.value = ' anna ';
    entry.code.value = '482 913';
    await entry.submit();
    assert.deepEqual(wishes, [{ name: 'anna', code: '482913', key: 'made 1' }]);
    assert.deepEqual(entered, [joined]);
    assert.equal(keys.keyOf('Anna'), 'k');
    assert.equal(entry.isBusy.value, true, 'until the browser has left the page');
    assert.deepEqual(make().known.value, ['Anna']);
  });

  it('needs only the name with the link', async () => {
    const { wishes, make } = setUp(undefined, '482913');
    const entry = make();
    entry.name.value = 'Anna';
    await entry.submit();
    assert.deepEqual(wishes, [{ name: 'Anna', code: '482913', key: 'made 1' }]);
  });

  it('goes on with the key, without a code', async () => {
    const { keys, wishes, entered, make } = setUp();
    keys.keep('Anna', 'k');
    await make().goOn('Anna');
    assert.deepEqual(wishes, [{ name: 'Anna', code: '', key: 'k' }]);
    assert.deepEqual(entered, [joined]);
  });

  it('forgets a name on this computer', () => {
    const { keys, make } = setUp();
    keys.keep('Anna', 'k');
    const entry = make();
    entry.forget('Anna');
    assert.deepEqual(entry.known.value, []);
    assert.equal(keys.keyOf('Anna'), null);
  });

  it('sends nothing that cannot be right, and says why', async () => {
    const { wishes, make } = setUp();
    const entry = make();
    await entry.submit();
    assert.equal(entry.problem.value?.field, 'name');
    entry.name.value = 'Anna';
    await entry.submit();
    assert.equal(entry.problem.value?.field, 'code');
    assert.deepEqual(wishes, []);
  });

  it('shows a refusal, and can be tried again', async () => {
    const { entered, make } = setUp(async () => ({ status: 403, body: '{"error": "found another code"}' }));
    const entry = make();
    entry.name.value = 'Anna';
    entry.code.value = '000000';
    await entry.submit();
    assert.equal(entry.problem.value?.field, 'code');
    assert.equal(entry.isBusy.value, false);
    assert.deepEqual(entered, []);
  });

  it('ends a wait that is too long, and says if there is no connection', async () => {
    for (const [error, text] of [[Object.assign(new Error('aborted'), { name: 'AbortError' }), /does not start/], [new TypeError('failed'), /does not answer/]] as const) {
      const { make } = setUp(() => Promise.reject(error));
      const entry = make();
      entry.name.value = 'Anna';
      entry.code.value = '482913';
      await entry.submit();
      assert.equal(entry.problem.value?.field, 'button');
      assert.match(entry.problem.value?.text ?? '', text);
      assert.equal(entry.isBusy.value, false);
    }
  });

  it('asks again with the same key, for an answer may have been lost; also after a reload', async () => {
    const { keys, wishes, make } = setUp(() => Promise.reject(new TypeError('failed')));
    for (const entry of [make(), make()]) {
      entry.name.value = 'Anna';
      entry.code.value = '482913';
      await entry.submit();
    }
    assert.deepEqual(wishes.map(({ key }) => key), ['made 1', 'made 1']);
    assert.deepEqual(keys.all(), [], 'nobody has joined');
  });

  it('asks once, however often Go is pressed', async () => {
    let answer = (_: { status: number; body: string }) => {};
    const { wishes, make } = setUp(() => new Promise((resolve) => (answer = resolve)));
    const entry = make();
    entry.name.value = 'Anna';
    entry.code.value = '482913';
    const first = entry.submit();
    await entry.submit();
    assert.equal(wishes.length, 1);
    answer({ status: 503, body: '{"error": "the class is full"}' });
    await first;
    assert.deepEqual(entry.problem.value, { field: 'button', text: 'The class is full.' });
  });
});
