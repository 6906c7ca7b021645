import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { pageAddress } from '../../../../host/page/source/wire/page_address.js';

const at = (protocol: string, pathname: string, search = '') => pageAddress({ protocol, host: 'room.local:8443', pathname, search });

describe('the address of a page', () => {
  it('has the connection beside it', () => {
    assert.deepEqual(at('http:', '/'), { folder: '/', socket: 'ws://room.local:8443/socket', stop: '/stop', isSeat: false, onlyLooks: false });
    assert.equal(at('http:', '/index.html').socket, 'ws://room.local:8443/socket');
  });

  it('has that of its seat in a class', () => {
    const seat = at('https:', '/robots/12/');
    assert.deepEqual(seat, { folder: '/robots/12/', socket: 'wss://room.local:8443/robots/12/socket', stop: '/robots/12/stop', isSeat: true, onlyLooks: false });
  });

  it('says that a teacher looks, also at the connection', () => {
    const seat = at('https:', '/robots/12/', '?look');
    assert.equal(seat.onlyLooks, true);
    assert.equal(seat.socket, 'wss://room.local:8443/robots/12/socket?look');
    assert.equal(seat.stop, '/robots/12/stop');
  });
});
