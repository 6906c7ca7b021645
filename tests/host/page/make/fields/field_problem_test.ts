import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { fieldProblem } from '../../../../../host/page/source/make/fields/field_problem.js';

describe('a refusal of a form', () => {
  it('names its field', () => {
    assert.deepEqual(fieldProblem("name: found 'class', expected a name: another one"), {
      field: 'name',
      text: "found 'class', expected a name: another one",
    });
    assert.deepEqual(fieldProblem('parameters.12.minimum: found 1, expected 2'), {
      field: 'parameters.12.minimum',
      text: 'found 1, expected 2',
    });
  });

  it('is shown as it is if it names none', () => {
    assert.deepEqual(fieldProblem('/home/me/x: cannot be created'), { field: '', text: '/home/me/x: cannot be created' });
    assert.deepEqual(fieldProblem('control is with desk-3'), { field: '', text: 'control is with desk-3' });
  });
});
