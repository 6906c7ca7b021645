import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { newExperiment } from '../../../../../host/page/source/make/search/experiment_defaults.js';
import { durationKey, evaluationsIn, withEvaluations } from '../../../../../host/page/source/make/search/time_presets.js';
import { caterpillar, methods, sinusoidal } from '../../support/search_program.js';

const [genetic, cmaEs] = methods.methods;
const experiment = newExperiment(caterpillar(), [sinusoidal], methods.methods);

describe('a search of a given time', () => {
  it('has as many evaluations as fit into it, in round numbers', () => {
    assert.equal(evaluationsIn(30, 0.0078), 3800);
    assert.equal(evaluationsIn(300, 0.5), 600);
    assert.equal(evaluationsIn(30, 0.7), 42);
    assert.equal(evaluationsIn(8 * 3600, 0.0078), 3_600_000);
  });

  it('has at least one, and no more than a search may have', () => {
    assert.equal(evaluationsIn(30, 100), 1);
    assert.equal(evaluationsIn(1e9, 1e-9), 1e9);
  });

  it('is not ended before by its generations', () => {
    assert.equal(withEvaluations(experiment, cmaEs, 3800).settings['generations'], undefined);
    assert.equal(withEvaluations(experiment, cmaEs, 3_600_000).settings['generations'], '180000');
    assert.equal(withEvaluations({ ...experiment, settings: { popsize: '100' } }, cmaEs, 200_000).settings['generations'], '2000');
    assert.equal(withEvaluations(experiment, genetic, 3_600_000).settings['generations'], undefined);
    assert.equal(withEvaluations(experiment, genetic, 3_600_000).evaluations, '3600000');
  });
});

describe('how long an evaluation takes', () => {
  const key = (part = {}, engine: string | null = 'reduced', workers = 2, run = { duration: 30 }) => durationKey({ ...experiment, ...part }, engine, workers, run);

  it('is measured again when something has changed that it depends on', () => {
    const racing = { after: '0.3', keep: '0.5' };
    for (const other of [key({ racing }), key({}, null), key({}, 'reduced', 1), key({}, 'reduced', 2, { duration: 60 })]) assert.notEqual(other, key());
  });

  it('does not depend on the method, or the number of evaluations', () => {
    assert.equal(key({ method: 'geneticAlgorithm', evaluations: '7', seed: '3' }), key());
  });
});
