import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { touchSeen, touchVerdict, type TouchWatch } from '../../../../host/page/source/modules/touch_watch.js';

// The verdict on the sensor of bit 0 after these readings.
function verdictAfter(...readings: number[]): string {
  const watch = readings.reduce<TouchWatch | null>((before, touch) => touchSeen(before, touch), null);
  return touchVerdict(watch, 0);
}

describe('the touch test', () => {
  it('passes a sensor that was released, pressed and released', () => {
    assert.equal(verdictAfter(0, 1, 0), 'works');
    assert.equal(verdictAfter(0, 0, 1, 1, 0, 0), 'works');
    assert.equal(verdictAfter(0, 1, 0, 1), 'works');
  });

  it('does not pass a sensor that is pressed from the start, and names it', () => {
    assert.equal(verdictAfter(1), 'stuck');
    assert.equal(verdictAfter(1, 1, 1), 'stuck');
    assert.equal(verdictAfter(1, 0), 'not yet', 'the robot was lifted');
    assert.equal(verdictAfter(1, 0, 1), 'pressed');
    assert.equal(verdictAfter(1, 0, 1, 0), 'works');
  });

  it('does not pass a sensor that does not come back, or that nobody pressed', () => {
    assert.equal(verdictAfter(0, 1, 1, 1), 'pressed');
    assert.equal(verdictAfter(0, 0, 0), 'not yet');
    assert.equal(verdictAfter(), 'not yet');
  });

  it('judges each sensor by itself', () => {
    const watch = [0b1000, 0b1001, 0b1010, 0b1000].reduce<TouchWatch | null>((before, touch) => touchSeen(before, touch), null);
    assert.deepEqual([0, 1, 2, 3].map((bit) => touchVerdict(watch, bit)), ['works', 'works', 'not yet', 'stuck']);
  });
});
