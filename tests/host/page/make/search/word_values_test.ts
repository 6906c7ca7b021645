import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { parseWord, wordValues } from '../../../../../host/page/source/make/search/word_values.js';
import { caterpillar, sinusoidal } from '../../support/search_program.js';

const degree = 180 / 2 ** 31;

describe('a word of a candidate', () => {
  it('names a parameter, joints and a value', () => {
    assert.deepEqual(parseWord('amplitude:J5=35'), { module: null, parameter: 'amplitude', joints: ['J5'], name: 'amplitude:J5', value: 35 });
    assert.deepEqual(parseWord('2.frequency:J1,J3=-0.25'), { module: 1, parameter: 'frequency', joints: ['J1', 'J3'], name: '2.frequency:J1,J3', value: -0.25 });
    assert.deepEqual(parseWord('amplitude=12.5'), { module: null, parameter: 'amplitude', joints: null, name: 'amplitude', value: 12.5 });
    for (const bad of ['amplitude', 'amplitude=', '=3', 'amplitude:J1=x']) assert.equal(parseWord(bad), null, bad);
  });
});

describe('the values of a candidate', () => {
  const draft = caterpillar();
  draft.behaviour.modules[0]!.values['amplitude'] = [35, 40, 40, 30, 20].map((value) => Math.round(value / degree));

  it('stand beside those of the draft', () => {
    assert.deepEqual(wordValues(['amplitude:J5=35', 'amplitude:J1=12.5'], draft, [sinusoidal]), [
      { name: 'amplitude:J5', unit: 'deg', candidate: '35', draft: '35', isSame: true },
      { name: 'amplitude:J1', unit: 'deg', candidate: '12.5', draft: '20', isSame: false },
    ]);
  });

  it('of several joints are the same only if all are', () => {
    assert.deepEqual(wordValues(['amplitude=40', 'amplitude:J4,J3=40'], draft, [sinusoidal]), [
      { name: 'amplitude', unit: 'deg', candidate: '40', draft: '20 to 40', isSame: false },
      { name: 'amplitude:J4,J3', unit: 'deg', candidate: '40', draft: '40', isSame: true },
    ]);
  });

  it('are those of the module that the word names', () => {
    const two = caterpillar();
    const [first] = two.behaviour.modules;
    two.behaviour.modules.push({ ...first!, joints: [4], values: { amplitude: [Math.round(10 / degree)], frequency: [2 ** 24] } });
    const values = wordValues(['1.amplitude:J1=10', '2.amplitude:J1=10', '2.amplitude:J5=10'], two, [sinusoidal]);
    assert.deepEqual(values.map(({ draft: own, isSame }) => [own, isSame]), [['40', false], ['10', true], ['', false]]);
  });

  it('stand alone where the draft has no such parameter or joint', () => {
    assert.deepEqual(wordValues(['winding_angle=3', 'amplitude:J9=3', 'nonsense'], draft, [sinusoidal]), [
      { name: 'winding_angle', unit: '', candidate: '3', draft: '', isSame: false },
      { name: 'amplitude:J9', unit: '', candidate: '3', draft: '', isSame: false },
    ]);
  });
});
