import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { dropToken, takeToken } from '../../../../host/page/source/wire/access_token.js';

function browser(hash: string) {
  const stored = new Map<string, string>();
  const addresses: string[] = [];
  return {
    stored,
    addresses,
    location: { hash, pathname: '/', search: '' } as Location,
    history: { replaceState: (_: unknown, __: string, address: string) => addresses.push(address) } as unknown as History,
    storage: {
      getItem: (key: string) => stored.get(key) ?? null,
      removeItem: (key: string) => void stored.delete(key),
      setItem: (key: string, value: string) => void stored.set(key, value),
    } as unknown as Storage,
  };
}

describe('the token', () => {
  it('is taken from the fragment, which leaves the address', () => {
    const { location, history, storage, addresses } = browser('#abc');
    assert.equal(takeToken(location, history, storage), 'abc');
    assert.deepEqual(addresses, ['/']);
  });

  it('survives a reload in the session storage', () => {
    const { location, history, storage } = browser('#abc');
    takeToken(location, history, storage);
    assert.equal(takeToken({ ...location, hash: '' }, history, storage), 'abc');
  });

  it('is kept for each seat of a class by itself, as they share an origin', () => {
    const { location, history, storage, stored, addresses } = browser('#abc');
    takeToken({ ...location, pathname: '/robots/3/', search: '?look' }, history, storage);
    assert.deepEqual([...stored], [['proleg.token/robots/3/', 'abc']]);
    assert.deepEqual(addresses, ['/robots/3/?look']);
    assert.equal(takeToken({ ...location, pathname: '/robots/4/', hash: '' }, history, storage), null);
    assert.equal(takeToken({ ...location, hash: '' }, history, storage), null);
  });

  it('is forgotten when the program has refused it', () => {
    const { location, history, storage } = browser('#abc');
    takeToken(location, history, storage);
    dropToken(location, storage);
    assert.equal(takeToken({ ...location, hash: '' }, history, storage), null);
  });

  it('is missing if neither has it', () => {
    const { location, history, storage, addresses } = browser('');
    assert.equal(takeToken(location, history, storage), null);
    assert.deepEqual(addresses, []);
  });
});
