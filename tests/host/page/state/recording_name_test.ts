import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { recordingName } from '../../../../host/page/source/state/recording_name.js';

describe('the name of a recording', () => {
  it('has the scenario and the local time', () => {
    assert.equal(recordingName('uniform.simulation.xml', new Date(2026, 0, 5, 7, 8, 9)), 'uniform-20260105-070809.proleg');
    assert.equal(recordingName('mine.xml', new Date(2026, 10, 22, 13, 24, 55)), 'mine-20261122-132455.proleg');
  });
});
