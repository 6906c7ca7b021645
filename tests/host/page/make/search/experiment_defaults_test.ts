import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { defaultRange, fitToDraft, newExperiment, newObjective, newParameter, rangeStep, settingsFor, withMethod } from '../../../../../host/page/source/make/search/experiment_defaults.js';
import type { AlgorithmDocument } from '../../../../../host/page/source/wire/messages.js';
import { caterpillar, methods, parameter, sinusoidal } from '../../support/search_program.js';

const degree = 180 / 2 ** 31;
const raw = (value: number) => Math.round(value / degree);

describe('a new experiment', () => {
  it('is a sensible search without a further click: CMA-ES, the amplitude of each joint, the distance', () => {
    const experiment = newExperiment(caterpillar(), [sinusoidal], methods.methods);
    assert.equal(experiment.method, 'cmaEs');
    assert.deepEqual(experiment.parameters, [
      { module: 0, parameter: 'amplitude', joints: null, same: false, lower: '0', upper: '60', step: '0.25', with_lower: true, with_upper: true, set: null },
    ]);
    assert.deepEqual(experiment.objectives, [{ name: '', goal: '', failed: '', terms: [{ measure: 'distance', weight: '' }] }]);
    assert.deepEqual([experiment.trials, experiment.confirmation, experiment.racing, experiment.reuse], [null, null, null, true]);
    assert.deepEqual(experiment.settings, { restartAfter: '5' }, 'else it ends on the first summit');
  });

  it('of a gait without an amplitude has the first parameter with a useful range', () => {
    const snake: AlgorithmDocument = { ...sinusoidal, parameters: [parameter('phase', { useful: [0, raw(90)] }), parameter('turn', { minimum: raw(-90), useful: [raw(-45), raw(45)] })] };
    const { parameters } = newExperiment(caterpillar(), [snake], methods.methods);
    assert.deepEqual(parameters.map((each) => each.parameter), ['turn']);
  });

  it('of a program with other methods has the first of them, and of a robot without a gait no parameter', () => {
    const draft = caterpillar({ behaviour: { file: '', modules: [] } });
    const experiment = newExperiment(draft, [sinusoidal], methods.methods.filter(({ tag }) => tag === 'pagmo'));
    assert.deepEqual([experiment.method, experiment.algorithm, experiment.parameters.length], ['pagmo', 'sade', 0]);
  });
});

describe('the range of a parameter', () => {
  it('is its useful part, in steps that are fine and round', () => {
    assert.deepEqual(defaultRange(parameter('amplitude')), { lower: '0', upper: '60', step: '0.25' });
    assert.deepEqual(defaultRange(sinusoidal.parameters[1]!), { lower: '0.1', upper: '2', step: '0.005' });
    assert.deepEqual(defaultRange(parameter('offset', { minimum: raw(-90), useful: [raw(-45), raw(45)] })), { lower: '-45', upper: '45', step: '0.25' });
  });

  it('of whole numbers has whole steps', () => {
    assert.deepEqual(defaultRange(parameter('reach', { unit: '', scale: 1, minimum: 0, maximum: 63, useful: [0, 8] })), { lower: '0', upper: '8', step: '1' });
    assert.deepEqual(defaultRange(parameter('give_up', { unit: '', scale: 1, minimum: 1, maximum: 60000, useful: [1000, 30000] })), { lower: '1000', upper: '30000', step: '100' });
  });

  it('ends where a step ends, as a program expects it', () => {
    const { lower, upper, step } = defaultRange(parameter('odd', { unit: '', scale: 1, minimum: 1, maximum: 10000, useful: [1, 10000] }));
    assert.equal((Number(upper) - Number(lower)) % Number(step), 0);
    assert.ok(Number(upper) <= 10000 && Number(upper) > 9900);
  });

  it('is all that is possible where nothing else is known', () => {
    const { useful: _, ...unknown } = parameter('gain');
    assert.deepEqual(defaultRange(unknown), { lower: '0', upper: '90', step: '0.25' });
  });

  it('has 240 to 600 steps', () => {
    for (const size of [0.3, 1, 1.9, 4.5, 8, 60, 90, 240, 3600]) {
      const steps = size / rangeStep(size);
      assert.ok(steps >= 240 - 1e-6 && steps <= 600 + 1e-6, `${steps} steps of ${size}`);
    }
  });
});

describe('the settings of a method', () => {
  it('keep what was typed for another one, if it has them', () => {
    const [genetic, cmaEs, sade] = methods.methods;
    assert.deepEqual(settingsFor(genetic, { popsize: '40', restartAfter: '5', gamode: '2' }), { popsize: '40', gamode: '2' });
    assert.deepEqual(settingsFor(cmaEs, { popsize: '40', restartAfter: '0' }), { popsize: '40', restartAfter: '0' });
    assert.deepEqual(settingsFor(sade, { generations: '7' }), {});
  });
});

describe('the experiment of the last search', () => {
  const before = { ...newExperiment(caterpillar(), [sinusoidal], methods.methods), objectives: [newObjective('speed')] };

  it('fits another draft without the parameters and joints that it does not have', () => {
    const parameters = [
      { ...newParameter(0, sinusoidal.parameters[0]!), joints: [0, 4] },
      { ...newParameter(0, sinusoidal.parameters[0]!), joints: [4] },
      newParameter(1, sinusoidal.parameters[0]!),
      { ...newParameter(0, sinusoidal.parameters[0]!), parameter: 'winding_angle' },
    ];
    const draft = caterpillar();
    draft.behaviour.modules[0]!.joints = [0, 1, 2, 3];
    const fitting = fitToDraft({ ...before, parameters }, draft);
    assert.deepEqual(fitting.parameters.map(({ parameter: name, joints }) => [name, joints]), [['amplitude', [0]]]);
    assert.equal(fitting.objectives[0]?.terms[0]?.measure, 'speed');
  });
});

describe('another method', () => {
  const map = { ...methods.methods[1]!, tag: 'mapElites', title: 'MAP-Elites', has_map: true };
  const experiment = newExperiment(caterpillar(), [sinusoidal], methods.methods);

  it('gets axes if it fills a map, and keeps those that were typed', () => {
    assert.deepEqual(withMethod(experiment, map).axes?.map(({ measure }) => measure), ['height', 'duty_factor']);
    const typed = [{ measure: 'speed', lowest: '0', highest: '1', cells: '5' }];
    assert.deepEqual(withMethod({ ...experiment, axes: typed }, map).axes, typed);
    assert.deepEqual(withMethod(experiment, methods.methods[0]!).axes, []);
  });
});
