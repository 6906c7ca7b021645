import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { KeyStore, makeKey } from '../../../../host/page/source/class/key_store.js';
import { MemoryStorage } from '../support/memory_storage.js';

describe('the keys of the people at a computer', () => {
  it('are found by name, the last one that joined first', () => {
    const store = new KeyStore(new MemoryStorage());
    store.keep('Anna', 'k1');
    store.keep('Ben', 'k2');
    assert.deepEqual(store.all(), [{ name: 'Ben', key: 'k2' }, { name: 'Anna', key: 'k1' }]);
    assert.equal(store.keyOf('Anna'), 'k1');
    assert.equal(store.keyOf('Carl'), null);
  });

  it('take another spelling of ASCII letters as the same name, as the program does', () => {
    const store = new KeyStore(new MemoryStorage());
    store.keep('Anna', 'old');
    store.keep('ANNA', 'new');
    assert.deepEqual(store.all(), [{ name: 'ANNA', key: 'new' }]);
    store.keep('ÄNNE', 'k');
    assert.equal(store.keyOf('änne'), null);
  });

  it('can be forgotten one by one', () => {
    const store = new KeyStore(new MemoryStorage());
    store.keep('Anna', 'k1');
    store.keep('Ben', 'k2');
    store.forget('anna');
    assert.deepEqual(store.all(), [{ name: 'Ben', key: 'k2' }]);
  });

  it('may have any name', () => {
    const store = new KeyStore(new MemoryStorage());
    for (const name of ['__proto__', 'constructor', '<script>alert(1)</script>', '"']) {
      assert.equal(store.keyOf(name), null);
      store.keep(name, `key of ${name}`);
      assert.equal(store.keyOf(name), `key of ${name}`);
    }
  });

  it('are as hard to guess as those of the program', () => {
    assert.match(makeKey(), /^[A-Za-z0-9_-]{43}$/);
    assert.notEqual(makeKey(), makeKey());
  });

  it('ignore what something else has stored', () => {
    for (const stored of ['', '{', 'null', '{}', '7', '[null, 7, {"name": "Anna"}, {"name": 1, "key": 2}]']) {
      const storage = new MemoryStorage();
      storage.setItem('proleg.class', stored);
      assert.deepEqual(new KeyStore(storage).all(), [], stored);
    }
  });
});
