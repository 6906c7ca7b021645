import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { copyText, paste, rangeOf, splitCells } from '../../../../host/page/source/state/value_table.js';
import type { Parameter } from '../../../../host/page/source/wire/messages.js';
import { Random } from '../support/random.js';

const joints = ['J3', 'J2', 'J1'];

// A value is a hundredth.
function parameter(name: string, wanted: number[], changes: Partial<Parameter> = {}): Parameter {
  return {
    slot: 1,
    name,
    unit: 'degree',
    scale: 0.01,
    minimum: 0,
    maximum: 9000,
    default: 0,
    help: '',
    internal: false,
    wraps: false,
    joints: [0, 1, 2],
    file: wanted,
    wanted,
    confirmed: wanted,
    tick: wanted.map(() => 0),
    ...changes,
  };
}

const amplitude = parameter('amplitude', [1000, 2000, 3050]);
const offset = parameter('offset', [100, 200], { slot: 2, joints: [0, 2] });
const table = [amplitude, offset];

function cell(row: number, column: number) {
  return rangeOf({ row, column }, { row, column });
}

describe('the table of values', () => {
  it('is copied as tab-separated text', () => {
    assert.equal(copyText(table, rangeOf({ row: 1, column: 2 }, { row: 0, column: 0 })), '10\t20\t30.5\n1\t\t2');
    assert.equal(copyText(table, rangeOf({ row: 0, column: 1 }, { row: 0, column: 1 })), '20');
  });

  it('takes its own copy without a change', () => {
    const all = rangeOf({ row: 0, column: 0 }, { row: 1, column: 2 });
    assert.deepEqual(paste(copyText(table, all), all, table, joints), { words: [], problems: [] });
  });

  it('fills from the chosen cell on, with decimal comma or point', () => {
    assert.deepEqual(paste('11,5\t12.25\r\n\t3\r\n', cell(0, 1), table, joints), {
      words: ['1.amplitude:J2=11.5', '1.amplitude:J1=12.25', '2.offset:J1=3'],
      problems: [],
    });
  });

  it('fills a range with one value', () => {
    const range = rangeOf({ row: 0, column: 1 }, { row: 0, column: 2 });
    assert.deepEqual(paste('7\n', range, table, joints).words, ['1.amplitude:J2=7', '1.amplitude:J1=7']);
  });

  it('takes nothing of a text with a bad cell, and says why', () => {
    const { words, problems } = paste('50\tabc\n1\t2', cell(0, 0), table, joints);
    assert.deepEqual(words, []);
    assert.deepEqual(problems, [
      { row: 0, column: 1, reason: "found 'abc', expected a number" },
      { row: 1, column: 1, reason: 'found 2 for J2, expected nothing: slot 2 does not drive it' },
    ]);
    const outside = paste('91\t1\n1', cell(1, 2), table, joints).problems;
    assert.deepEqual(outside.map(({ row, column }) => [row, column]), [[1, 2], [1, 3], [2, 2]]);
    assert.match(outside[1]?.reason ?? '', /row 2, column 4, expected at most 2 rows and 3 columns/);
  });

  it('rejects what is no single number', () => {
    for (const text of ['1,2,3', '1.234,5', '1e999', '0x', 'NaN', '--1', '1 2', '90.1', '-1']) {
      assert.equal(paste(text, cell(0, 0), table, joints).problems.length, 1, text);
    }
  });

  it('never fails on a text from elsewhere', () => {
    const random = new Random(11);
    const characters = '0123456789.,-\t\n\r "abc';
    for (let round = 0; round < 500; round += 1) {
      let text = '';
      for (let i = 0; i < 30; i += 1) text += characters[random.integer(0, characters.length - 1)];
      const { words, problems } = paste(text, cell(random.integer(0, 1), random.integer(0, 2)), table, joints);
      assert.ok(words.length === 0 || problems.length === 0);
      assert.ok(words.length + problems.length <= splitCells(text).flat().length);
    }
  });
});
