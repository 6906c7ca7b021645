import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { quantile, summarise, summaryText } from './report.js';

const figure = { name: 'delay', unit: 'ms', wanted: { median: 15, p99: 30 }, conditions: 'a test' };
const from1 = (last: number) => Array.from({ length: last }, (_, i) => last - i);

describe('a figure', () => {
  it('has the median and the 99th percentile of its samples by nearest rank', () => {
    assert.equal(quantile(from1(100), 0.5), 50);
    assert.equal(quantile(from1(100), 0.99), 99);
    assert.equal(quantile([7], 0.99), 7);
  });

  it('is met if both are within their limits', () => {
    assert.equal(summarise({ ...figure, samples: from1(29) }).isMet, true);
    assert.equal(summarise({ ...figure, samples: from1(31) }).isMet, false);
    assert.equal(summarise({ ...figure, samples: [...from1(10), 31] }).isMet, false);
    assert.equal(summarise({ ...figure, wanted: {}, samples: [99] }).isMet, null);
  });

  it('with a lower limit has the value that 99 % of the samples reach', () => {
    const rate = { ...figure, wanted: { median: 30, least: true } };
    const summary = summarise({ ...rate, samples: from1(100) });
    assert.equal(summary.p99, 2);
    assert.equal(summary.isMet, true);
    assert.equal(summarise({ ...rate, samples: [29, 29, 60] }).isMet, false);
  });

  it('without samples, or with one that is no number, was not measured', () => {
    assert.throws(() => summarise({ ...figure, samples: [] }), /delay: found 0 samples/);
    assert.throws(() => summarise({ ...figure, samples: [1, NaN] }), /delay/);
  });

  it('says what was missed', () => {
    assert.match(summaryText(summarise({ ...figure, samples: [16, 16] })), /median 16, p99 16 ms\n.*MISSED/);
  });
});
