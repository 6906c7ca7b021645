import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { candidateRemarks, countText, durationText, evaluationsText, progressText, resultLines, resumeKind, sentence, shortNumber, withUnit } from '../../../../../host/page/source/make/search/search_text.js';
import type { SearchResult } from '../../../../../host/page/source/wire/messages.js';
import { entry, openedSearch } from '../../support/search_program.js';

describe('the state of a search', () => {
  it('says how far it is, how long it takes, and why it ended', () => {
    assert.equal(progressText(entry({ made: 320, left_s: 41.5 })), 'running, 320 of 2,000 evaluations, 42 s left');
    assert.equal(progressText(entry({ state: 'stopping', made: 1320 })), 'stopping …, 1,320 of 2,000 evaluations');
    assert.equal(progressText(entry({ state: 'ended', made: 411, ending: 'the candidates no longer differ' })), 'ended, 411 of 2,000 evaluations: the candidates no longer differ');
    assert.equal(progressText(entry({ state: 'interrupted', made: 7, planned: null })), 'interrupted, 7 evaluations');
    assert.equal(progressText(entry({ state: 'unreadable', made: 0, planned: null })), 'cannot be read');
    assert.equal(progressText(entry({ state: 'unread', made: 0, planned: null })), 'reading …');
    assert.equal(evaluationsText({ made: 1_234_567, planned: 3_600_001 }), '1,234,567 of 3,600,001');
  });

  it('says whether it can go on, and whether it needs more evaluations', () => {
    assert.equal(resumeKind(entry()), 'none');
    assert.equal(resumeKind(entry({ state: 'interrupted', made: 7 })), 'as it is');
    assert.equal(resumeKind(entry({ state: 'interrupted', made: 2000 })), 'with more');
    assert.equal(resumeKind(entry({ state: 'ended', made: 2000 })), 'with more');
    assert.equal(resumeKind(entry({ state: 'unreadable' })), 'none');
    assert.equal(resumeKind(entry({ state: 'unread' })), 'none');
  });
});

describe('numbers in words', () => {
  it('are short', () => {
    assert.equal(shortNumber(1.889590852728988), '1.8896');
    assert.equal(shortNumber(40), '40');
    assert.equal(shortNumber(2.78e-17), '0', 'what is left over from a sum');
    assert.equal(shortNumber(-2.5e-7), '-2.5e-7');
    assert.equal(shortNumber(NaN), '–');
    assert.equal(withUnit(2.1715, 'm'), '2.1715 m');
    assert.equal(withUnit(0.25, ''), '0.25');
    assert.equal(withUnit(null, 'm'), '–');
    assert.equal(countText(108_175_616_801), '1.1·10^11');
    assert.equal(countText(2001), '2,001');
  });

  it('stand in sentences', () => {
    assert.equal(sentence('learns which values belong together; it needs the fewest evaluations'), 'Learns which values belong together; it needs the fewest evaluations.');
    assert.deepEqual([sentence('Is one.'), sentence('')], ['Is one.', '']);
  });

  it('of seconds are those that a person uses', () => {
    assert.deepEqual([0.2, 41.5, 119, 150, 3600, 9000, 90 * 3600].map(durationText), ['1 s', '42 s', '119 s', '3 min', '60 min', '2 h 30 min', '4 days']);
  });
});

const result: SearchResult = {
  engine: 'reduced',
  judge: 'ode',
  best_number: 55,
  best_score: 1.889590852728988,
  best_search_scores: { distance: 1.8781374338697359 },
  confirmed_mean: 1.889590852728988,
  confirmed_standard_deviation: 0,
  confirmations: [{ number: 55, runs: 1, mean: 1.889590852728988, worst: 1.889590852728988 }],
  baseline: { score: 1.670178777560728, moved: [] },
  better_than_baseline: true,
  gain_percent: 13.137041262655018,
  at_bounds: [
    { dimension: 'amplitude:J4', value: 40, bound: 'highest' },
    { dimension: 'amplitude:J3', value: 40, bound: 'highest' },
    { dimension: 'amplitude:J1', value: 0, bound: 'lowest' },
  ],
};

describe('the result of a search', () => {
  it('has the best as ODE has judged it, the gain, and what a wider range may give', () => {
    assert.deepEqual(resultLines(result, openedSearch()), [
      'The best is candidate 55: 1.889591 m in ODE; in the search it had 1.8781 m (reduced).',
      "The scenario's own values had 1.6702 m. The gain is 13.1 %.",
      'amplitude:J4, amplitude:J3 are at the highest value of their ranges: a wider range may give more.',
      'amplitude:J1 is at the lowest value of its range: a wider range may give more.',
    ]);
  });

  it('of ODE itself has one score', () => {
    const { judge: _, ...own } = result;
    assert.equal(resultLines({ ...own, at_bounds: [] }, openedSearch({ engine: 'ode' }))[0], 'The best is candidate 55: 1.889591 m.');
  });

  it('with noise has the mean of fresh runs', () => {
    const confirmations = [{ number: 55, runs: 10, mean: 1.36, worst: 1.33 }];
    const lines = resultLines({ ...result, confirmed_mean: 1.36, confirmed_standard_deviation: 0.0123, confirmations, at_bounds: [] }, openedSearch());
    assert.equal(lines[0], 'The best is candidate 55: 1.36 m, the mean of 10 fresh runs in ODE (standard deviation 0.012, worst 1.33); in the search it had 1.8781 m.');
  });

  it('says if there is no gain, which values of the scenario could not be searched, and what failed', () => {
    const moved = [{ dimension: 'amplitude:J5', scenario: '40.1', baseline: '40' }];
    const lines = resultLines({ ...result, baseline: { score: 1.9, moved }, better_than_baseline: false, gain_percent: 0, at_bounds: [], failed: 3 }, openedSearch());
    assert.deepEqual(lines.slice(1), [
      "The scenario's own values had 1.9 m. The gain is 0.0 %.",
      'No candidate was better than that.',
      "The scenario's amplitude:J5 = 40.1 is not among the values of the search: 40 took its place.",
      '3 evaluations have failed.',
    ]);
  });

  it('says why the own values have no score', () => {
    const lines = resultLines({ ...result, baseline: { score: null, failure: 'the robot fell over', moved: [] }, better_than_baseline: null, gain_percent: null, at_bounds: [] }, openedSearch());
    assert.equal(lines[1], "The scenario's own values have no score: the robot fell over.");
  });
});

describe('a candidate', () => {
  const candidate = { number: 0, scores: [1], words: [], measures: {}, failure: null, given_up: false, reused: false };

  it('has remarks about what its numbers do not say', () => {
    assert.deepEqual(candidateRemarks(candidate, true), ['The values that the scenario had.']);
    assert.deepEqual(candidateRemarks(candidate, false), []);
    assert.deepEqual(candidateRemarks({ ...candidate, number: 5, failure: 'it left the ground', given_up: true, reused: true }, true), [
      'It failed: it left the ground',
      'It was given up before its time was over: its score is extrapolated.',
      'The same values were evaluated before.',
    ]);
  });
});
