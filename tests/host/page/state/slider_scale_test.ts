import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { describe, it } from 'node:test';
import { SliderScale, type ScaledParameter } from '../../../../host/page/source/state/slider_scale.js';

// Values in the unit, with raw steps of a millionth.
function parameter(minimum: number, maximum: number, useful?: [number, number]): ScaledParameter {
  const raw = (value: number) => Math.round(value * 1e6);
  const limits = { minimum: raw(minimum), maximum: raw(maximum), scale: 1e-6 };
  return useful === undefined ? limits : { ...limits, useful: [raw(useful[0]), raw(useful[1])] };
}

const frequency = new SliderScale(parameter(0, 20, [0.1, 2]));
const phase = new SliderScale(parameter(-180, 180, [-120, 120]));
const isNear = (found: number, expected: number, within = 1e-9) =>
  assert.ok(Math.abs(found - expected) <= within, `found ${found}, expected ${expected}`);

// The limits of all parameters, as `proleg algorithms --markdown` writes them. An angle without limits is -180 to 180.
function declaredRanges(): { name: string; minimum: number; maximum: number }[] {
  const rows = readFileSync('docs/algorithms.md', 'utf8').matchAll(/^\| `(\w+)` \|[^|]*\|[^|]*\| ([^|]*) \| 0x/gm);
  return [...rows].map(([, name, range]) => {
    const limits = /^(\S+) to (\S+)$/.exec(range ?? '');
    return { name: name ?? '', minimum: Number(limits?.[1] ?? -180), maximum: Number(limits?.[2] ?? 180) };
  });
}

describe('the way of a slider', () => {
  it('has the useful range in the middle 70 %, and all other values at the ends', () => {
    isNear(phase.positionOf(-180), 0);
    isNear(phase.positionOf(-120), 0.15);
    isNear(phase.positionOf(0), 0.5);
    isNear(phase.positionOf(60), 0.675);
    isNear(phase.positionOf(120), 0.85);
    isNear(phase.positionOf(180), 1);
    assert.deepEqual(phase.marks, [0.15, 0.85]);
  });

  it('stretches no end: values outside get at most their part of the range', () => {
    isNear(frequency.positionOf(0.1), 0.005);
    isNear(frequency.positionOf(2), 0.85);
  });

  it('has no compressed end where the useful range ends with the range', () => {
    const amplitude = new SliderScale(parameter(0, 90, [0, 60]));
    isNear(amplitude.positionOf(30), 0.425);
    assert.deepEqual(amplitude.marks, [0.85]);
  });

  it('is linear and without marks if the whole range is useful', () => {
    for (const scale of [new SliderScale(parameter(-90, 90)), new SliderScale(parameter(-90, 90, [-90, 90]))]) {
      isNear(scale.positionOf(45), 0.75);
      assert.deepEqual(scale.marks, []);
    }
  });

  it('reaches both limits exactly, and goes beyond neither', () => {
    const odd = new SliderScale(parameter(0.05, 1.333, [0.1, 1]));
    isNear(odd.valueAt(0), 0.05);
    isNear(odd.valueAt(1), 1.333);
    isNear(odd.positionOf(-5), 0);
    isNear(odd.positionOf(5), 1);
  });

  it('snaps to the steps of the parameter', () => {
    assert.equal(frequency.step, 0.05);
    for (let position = 0; position < 1; position += 0.001) {
      const steps = frequency.valueAt(position) / frequency.step;
      isNear(steps, Math.round(steps), 1e-6);
    }
  });

  it('has one value at a range without width', () => {
    const fixed = new SliderScale(parameter(3, 3));
    assert.deepEqual([fixed.positionOf(3), fixed.valueAt(0), fixed.valueAt(0.5), fixed.stepped(3, 1)], [0, 3, 3, 3]);
  });

  it('goes by steps of the value with the keys, within the limits', () => {
    isNear(frequency.stepped(1, 1), 1.05);
    isNear(frequency.stepped(1.02, -1), 0.95);
    isNear(frequency.stepped(1, 10), 1.5);
    assert.equal(frequency.stepped(1, Infinity), 20);
    assert.equal(frequency.stepped(1, -Infinity), 0);
    assert.equal(frequency.stepped(20, 1), 20);
  });

  it('goes up with the value, there and back, for every parameter of every algorithm', () => {
    const ranges = declaredRanges();
    assert.ok(ranges.length > 80, `found ${ranges.length} parameters`);
    for (const { name, minimum, maximum } of ranges) {
      const span = maximum - minimum;
      const usefuls: [number, number][] = [[0, 1], [0.1, 0.4], [0, 0.02], [0.98, 1], [0.45, 0.55]];
      for (const useful of usefuls) {
        const scale = new SliderScale(parameter(minimum, maximum, [minimum + useful[0] * span, minimum + useful[1] * span]));
        let before = -1;
        const steps = Math.round(span / scale.step);
        for (let step = 0; step <= steps; step += Math.max(1, Math.floor(steps / 500))) {
          const value = Math.min(maximum, minimum + step * scale.step);
          const position = scale.positionOf(value);
          assert.ok(position > before && position <= 1, `${name}: found ${position} at ${value} behind ${before}`);
          isNear(scale.valueAt(position), value, 1e-6 * span);
          before = position;
        }
      }
    }
  });
});
