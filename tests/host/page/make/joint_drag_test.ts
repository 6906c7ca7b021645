// Where a joint comes that is dragged along the chain.
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { columnAfter, placeAt, scrollStep } from '../../../../host/page/source/make/joint_drag.js';

const columns = [0, 40, 80].map((left) => ({ left, right: left + 40 }));

describe('a joint that is dragged', () => {
  it('comes between the columns around the pointer', () => {
    assert.deepEqual([-10, 19, 21, 59, 61, 99, 101, 500].map((x) => placeAt(x, columns)), [0, 0, 1, 1, 2, 2, 3, 3]);
  });

  it('stays on both sides of its own place', () => {
    assert.deepEqual([0, 1, 2, 3].map((place) => columnAfter(1, place)), [0, 1, 1, 2]);
  });

  it('scrolls a view near its sides only', () => {
    const view = { left: 100, right: 400 };
    assert.ok(scrollStep(110, view) < 0);
    assert.equal(scrollStep(250, view), 0);
    assert.ok(scrollStep(395, view) > 0);
  });
});
