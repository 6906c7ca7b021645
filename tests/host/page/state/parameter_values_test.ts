import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import {
  decimalsOf,
  formatNumber,
  formatRaw,
  parseValue,
  roundStep,
  setWord,
  sliderStep,
  splitHelp,
  summarise,
} from '../../../../host/page/source/state/parameter_values.js';
import type { Parameter } from '../../../../host/page/source/wire/messages.js';

const degree = 90 / 2 ** 30;
const amplitude: Parameter = {
  slot: 1,
  name: 'amplitude',
  unit: 'degree',
  scale: degree,
  minimum: 0,
  maximum: 2 ** 30,
  default: 0,
  help: '',
  internal: false,
  wraps: false,
  joints: [0, 1, 2],
  file: [1, 1, 1],
  wanted: [1, 1, 1],
  confirmed: [1, 1, 1],
  tick: [0, 0, 0],
};
const raw = (degrees: number) => Math.round(degrees / degree);

describe('the step of a slider', () => {
  it('is 1, 2 or 5 times a power of ten', () => {
    assert.deepEqual([0.225, 0.5, 7, 1, 0.00999].map(roundStep).map((step) => Number(step.toPrecision(6))), [0.2, 0.5, 5, 1, 0.005]);
  });

  it('is 0.2 degrees for 0 to 90', () => {
    assert.ok(Math.abs(sliderStep(amplitude) - 0.2) < 1e-12);
  });

  it('decides the digits', () => {
    assert.deepEqual([0.2, 1, 50, 0.005].map(decimalsOf), [1, 0, 0, 3]);
  });
});

describe('a value as text', () => {
  it('has no fraction that only the number format has', () => {
    assert.equal(formatRaw(raw(40), amplitude), '40');
    assert.equal(formatRaw(raw(40) - 1, amplitude), '40');
  });

  it('shows what was typed', () => {
    assert.equal(formatRaw(raw(33.25), amplitude), '33.25');
    assert.equal(formatRaw(raw(-0.0001), amplitude), '0');
  });

  it('keeps the zeros of whole numbers', () => {
    assert.equal(formatNumber(1200, 0), '1200');
    assert.equal(formatNumber(10.5, 3), '10.5');
  });
});

describe('a typed value', () => {
  it('may have a comma', () => {
    assert.equal(parseValue(' 33,5 ', amplitude), 33.5);
  });

  it('is rejected with what was found and what was expected', () => {
    assert.equal(parseValue('much', amplitude), "found 'much', expected a number");
    assert.equal(parseValue('', amplitude), "found '', expected a number");
    assert.equal(parseValue('91', amplitude), 'found 91, expected 0 to 90 degree');
  });

  it('has no limits if it is an angle that wraps', () => {
    assert.equal(parseValue('-270', { ...amplitude, wraps: true }), -270);
  });

  it('may be a limit', () => {
    assert.equal(parseValue('90', amplitude), 90);
    assert.equal(parseValue('0', amplitude), 0);
  });
});

describe('a word of --set', () => {
  it('names the slot, the parameter and the joint', () => {
    assert.equal(setWord(amplitude, null, 30), '1.amplitude=30');
    assert.equal(setWord(amplitude, 'J2', 30.5), '1.amplitude:J2=30.5');
  });

  it('has plain decimals without an exponent', () => {
    assert.equal(setWord(amplitude, null, 1e-7), '1.amplitude=0.0000001');
    assert.equal(setWord(amplitude, null, 0.1 + 0.2), '1.amplitude=0.3');
  });
});

describe('a summary of a parameter', () => {
  it('tells file, wanted and confirmed values apart', () => {
    const summary = summarise({ ...amplitude, wanted: [1, 2, 2], confirmed: [1, 2, 1], tick: [0, 120, 0] });
    assert.deepEqual(summary, { isUniform: false, isChanged: true, changed: [false, true, true], confirmed: 2, tick: 120 });
  });

  it('of an untouched one has nothing changed', () => {
    assert.deepEqual(summarise(amplitude), { isUniform: true, isChanged: false, changed: [false, false, false], confirmed: 3, tick: 0 });
  });
});

describe('the help of a parameter', () => {
  it('is an everyday sentence, then details', () => {
    assert.deepEqual(splitHelp('How fast it is. Rate a; 95 % takes 9.49/a. No more.'), {
      sentence: 'How fast it is.',
      details: 'Rate a; 95 % takes 9.49/a. No more.',
    });
    assert.deepEqual(splitHelp('How far the joint swings.'), { sentence: 'How far the joint swings.', details: '' });
    assert.deepEqual(splitHelp('share of 0.5 of the wave'), { sentence: 'share of 0.5 of the wave', details: '' });
  });
});
