import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { colourPlace } from '../../../../host/page/source/panels/chart_theme.js';

describe('the colours of a map', () => {
  it('are blue where positive and orange where negative, dark at the ends; 0 is pale only between both signs', () => {
    assert.equal(colourPlace(8, [2, 8]), -1);
    assert.ok(colourPlace(2, [2, 8]) < 0 && colourPlace(2, [2, 8]) > -0.2);
    assert.equal(colourPlace(-8, [-8, -2]), 1);
    assert.ok(colourPlace(-2, [-8, -2]) > 0 && colourPlace(-2, [-8, -2]) < 0.2);
    assert.ok(colourPlace(0, [-1, 4]) === 0);
    assert.equal(colourPlace(1, [-1, 4]), -colourPlace(-1, [-1, 4]));
    assert.equal(colourPlace(3, [3, 3]), -1);
  });
});
