import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { describeUpdate } from '../../../../host/page/source/panels/program_band.js';

const program = { version: '0.2.0', has_documentation: true, is_replaced: false, is_other_version: false };

describe('the line about an update', () => {
  it('is missing if there was none', () => {
    assert.equal(describeUpdate(null, false, false), null);
    assert.equal(describeUpdate(program, false, false), null);
    assert.equal(describeUpdate(program, false, true), null);
  });

  it('says what to do', () => {
    assert.match(describeUpdate({ ...program, is_replaced: true }, false, false) ?? '', /start “proleg ui” again/);
    for (const what of ['is_replaced', 'is_other_version']) {
      assert.match(describeUpdate({ ...program, [what]: true }, false, true) ?? '', /Your teacher has to start the class again/);
    }
    assert.match(describeUpdate(program, true, false) ?? '', /Reload the page/);
    assert.match(describeUpdate({ ...program, is_replaced: true }, true, false) ?? '', /Reload the page/);
  });
});
