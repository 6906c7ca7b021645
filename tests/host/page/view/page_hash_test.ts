import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { pageSignal } from '../support/page_signal.js';
import { followPageHash, readPageHash } from '../../../../host/page/source/view/page_hash.js';
import type { PageName } from '../../../../host/page/source/view/robot_view.js';
import { takeToken } from '../../../../host/page/source/wire/access_token.js';

function browser() {
  const addresses: string[] = [];
  const history = { replaceState: (_: unknown, __: string, address: string) => void addresses.push(address) } as unknown as History;
  return { addresses, history, location: { pathname: '/', search: '', hash: '' } as Location };
}

describe('the page in the address', () => {
  it('is shown after a reload', () => {
    const { addresses, history, location } = browser();
    const shownPage = pageSignal<PageName>('live');
    followPageHash({ shownPage: shownPage as never }, readPageHash('#modules'), { ...location, hash: '#modules' }, history);
    assert.equal(shownPage.value, 'modules');
    assert.deepEqual(addresses, []);
  });

  it('follows the page that is shown', () => {
    const { addresses, history, location } = browser();
    const shownPage = pageSignal<PageName>('live');
    followPageHash({ shownPage: shownPage as never }, readPageHash(''), location, history);
    assert.equal(shownPage.value, 'live');
    for (const page of ['make', 'modules', 'recordings', 'live'] as const) shownPage.value = page;
    assert.deepEqual(addresses, ['/#modules', '/']);
  });

  it('is no token', () => {
    const { history, location } = browser();
    const storage = { getItem: () => 'stored', setItem: () => assert.fail('the page is no token') } as unknown as Storage;
    assert.equal(takeToken({ ...location, hash: '#modules' }, history, storage, readPageHash('#modules').token), 'stored');
    assert.deepEqual(readPageHash('#token'), { token: 'token', page: null });
  });

  it('may come with a token, for a link from another page', () => {
    const { addresses, history, location } = browser();
    const shownPage = pageSignal<PageName>('live');
    const hash = readPageHash('#token&recordings');
    assert.deepEqual(hash, { token: 'token', page: 'recordings' });
    followPageHash({ shownPage: shownPage as never }, hash, location, history);
    assert.equal(shownPage.value, 'recordings');
    assert.deepEqual(addresses, [], 'taking the token has cleaned the address');
    followPageHash({ shownPage: shownPage as never }, readPageHash('#recordings'), { ...location, hash: '#recordings' }, history);
    assert.deepEqual(addresses, ['/'], 'only Modules stays in it');
  });
});
