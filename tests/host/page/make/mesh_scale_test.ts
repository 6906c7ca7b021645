import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { isPlausible, sidesOf, sizeText, suggestedUnit, turnedSides } from '../../../../host/page/source/make/mesh_scale.js';

const box = (longest: number) => ({ lowest: [-longest / 2, 0, 0] as [number, number, number], highest: [longest / 2, longest / 3, longest / 4] as [number, number, number] });

describe('the unit of a mesh', () => {
  it('is metres if that is a usual size', () => {
    assert.equal(suggestedUnit(box(0.5), 'world')?.name, 'm');
    assert.ok(isPlausible(box(0.06), 1, 'module'));
    assert.ok(!isPlausible(box(60), 1, 'module'));
  });

  it('is millimetres for what modellers write, and centimetres or inches where those fit better', () => {
    assert.equal(suggestedUnit(box(60), 'world')?.name, 'mm');
    assert.equal(suggestedUnit(box(60), 'module')?.name, 'mm');
    assert.equal(suggestedUnit(box(7), 'module')?.name, 'cm');
    assert.equal(suggestedUnit(box(0.6), 'module')?.name, 'inch');
  });

  it('is not suggested if no size is a usual one', () => {
    assert.equal(suggestedUnit(box(1e6), 'world'), null);
    assert.equal(suggestedUnit(box(1e-6), 'module'), null);
  });
});

describe('the size of a mesh', () => {
  it('is text with three digits in a unit that fits', () => {
    assert.equal(sizeText(sidesOf(box(60), 0.001)), '60 × 20 × 15 mm');
    assert.equal(sizeText(sidesOf(box(60), 0.0254)), '1.52 × 0.508 × 0.381 m');
    assert.equal(sizeText(sidesOf(box(6000), 1)), '6 × 2 × 1.5 km');
    assert.equal(sizeText([0.5, 0.5, 0]), '500 × 500 × 0 mm');
  });

  it('has its sides exchanged by turns of 90 degrees', () => {
    assert.deepEqual(turnedSides([1, 2, 3], [0, 0, 0]), [1, 2, 3]);
    assert.deepEqual(turnedSides([1, 2, 3], [1, 0, 0]), [1, 3, 2]);
    assert.deepEqual(turnedSides([1, 2, 3], [2, 3, 0]), [3, 2, 1]);
    assert.deepEqual(turnedSides([1, 2, 3], [1, 1, 0]), [2, 3, 1]);
  });
});
