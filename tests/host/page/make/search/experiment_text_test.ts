import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { newExperiment } from '../../../../../host/page/source/make/search/experiment_defaults.js';
import { freeName, plainExperiment, plainText, proposedName } from '../../../../../host/page/source/make/search/experiment_text.js';
import { caterpillar, methods, sinusoidal } from '../../support/search_program.js';

const experiment = newExperiment(caterpillar(), [sinusoidal], methods.methods);

describe('the numbers of an experiment', () => {
  it('take decimal commas, and lists with blanks, commas or semicolons between them', () => {
    for (const [typed, expected] of [
      ['0,25', '0.25'],
      [' 40 ', '40'],
      ['0 10  20', '0 10 20'],
      ['0,5 1,5', '0.5 1.5'],
      ['0, 10, 20', '0 10 20'],
      ['0,5; 1,5', '0.5 1.5'],
      ['-45', '-45'],
      ['1e3', '1e3'],
      ['grip', 'grip'],
      ['', ''],
    ] as const) {
      assert.equal(plainText(typed), expected, typed);
    }
  });

  it('are sent as the program reads them, from all parts of the form', () => {
    const plain = plainExperiment({
      ...experiment,
      settings: { sigma0: '0,7', popsize: ' ' },
      parameters: [{ ...experiment.parameters[0]!, step: '0,5', set: '0, 10' }],
      objectives: [{ name: ' thrifty gait ', goal: 'maximise', failed: '-1,5', terms: [{ measure: 'distance', weight: '0,1' }] }],
      heading: '22,5',
      trials: { count: '5', aggregate: 'worst', random_numbers: 'common', friction: '0,1', mass: '', servo_gain: '', latency: '', contact_noise: '' },
      racing: { after: '0,3', keep: '0,5' },
    });
    assert.deepEqual(plain.settings, { sigma0: '0.7' }, 'an empty one is left to the method');
    assert.deepEqual([plain.parameters[0]?.step, plain.parameters[0]?.set, plain.parameters[0]?.same], ['0.5', '0 10', false]);
    assert.deepEqual(plain.objectives[0], { name: 'thrifty gait', goal: 'maximise', failed: '-1.5', terms: [{ measure: 'distance', weight: '0.1' }] });
    assert.deepEqual([plain.heading, plain.trials?.friction, plain.racing?.after, plain.confirmation], ['22.5', '0.1', '0.3', null]);
  });
});

describe('the name of a search', () => {
  it('says what is searched how', () => {
    assert.equal(proposedName(experiment, []), 'cma_es_distance');
    assert.equal(proposedName({ ...experiment, method: 'geneticAlgorithm' }, []), 'genetic_algorithm_distance');
    assert.equal(proposedName({ ...experiment, method: 'pagmo', algorithm: 'sade' }, []), 'sade_distance');
  });

  it('is one that no other search has', () => {
    assert.equal(proposedName(experiment, ['searches/cma_es_distance', 'other/cma_es_distance_2']), 'cma_es_distance_3');
    assert.equal(freeName('wave', ['searches/wave_2']), 'wave');
  });
});
