import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { Freshness } from '../../../../host/page/source/state/freshness.js';

describe('the age of what the page shows', () => {
  it('is nothing to speak of for 2 s, then whole seconds', () => {
    const freshness = new Freshness();
    freshness.note(1000);
    freshness.check(3000);
    assert.equal(freshness.age.value, null);
    freshness.check(3001);
    assert.equal(freshness.age.value, 2);
    freshness.check(6500);
    assert.equal(freshness.age.value, 5);
  });

  it('ends with new data', () => {
    const freshness = new Freshness();
    freshness.note(0);
    freshness.check(9000);
    freshness.note(9100);
    assert.equal(freshness.age.value, null);
  });

  it('is unknown before the first data', () => {
    const freshness = new Freshness();
    freshness.check(9000);
    assert.equal(freshness.age.value, null);
  });
});
