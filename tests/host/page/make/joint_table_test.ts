// The table of joints: what is copied, and what a text from a spreadsheet changes.
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { copyJoints, jointCellText, jointColumns, pasteJoints } from '../../../../host/page/source/make/joint_table.js';
import { rangeOf } from '../../../../host/page/source/state/value_table.js';
import type { DraftJoint } from '../../../../host/page/source/wire/messages.js';

function joint(name: string, changes: Partial<DraftJoint> = {}): DraftJoint {
  return { name, editable: true, axis: [1, 0, 0], limits: [-90, 90], torque: 0.4, speed: 4.5, ...changes };
}

// From the tail; the program counts from the head: J1 is joint 2.
const joints = [joint('J1'), joint('J2', { axis: [0, 0, 1], torque: 0.25 }), joint('J3', { limits: [-45.5, 60] })];

function cell(row: number, column: number) {
  return rangeOf({ row, column }, { row, column });
}

const all = rangeOf({ row: 0, column: 0 }, { row: 2, column: jointColumns.length - 1 });
const [name, axis, lower, torque] = [0, 1, 2, 4];

describe('the table of joints', () => {
  it('is copied as tab-separated text, with titles if all columns are chosen', () => {
    assert.deepEqual(copyJoints(joints, all).split('\n'), [
      'name\taxis (°)\tlowest angle (°)\thighest angle (°)\ttorque (Nm)\tspeed (rad/s)',
      'J1\t0\t-90\t90\t0.4\t4.5',
      'J2\t90\t-90\t90\t0.25\t4.5',
      'J3\t0\t-45.5\t60\t0.4\t4.5',
    ]);
    assert.equal(copyJoints(joints, rangeOf({ row: 1, column: lower }, { row: 2, column: 3 })), '-90\t90\n-45.5\t60');
  });

  it('takes its own copy without a change, an axis that is askew too', () => {
    const askew = [...joints, joint('J4', { axis: [1, 0.5, 0] })];
    const range = rangeOf({ row: 0, column: 0 }, { row: 3, column: 5 });
    assert.equal(jointCellText(askew[3]!, axis), '1 0.5 0');
    assert.deepEqual(pasteJoints(copyJoints(askew, range), range, askew), { joints: [], problems: [], missing: 0 });
  });

  it('fills from the chosen cell on, with decimal comma or point, and leaves what is empty', () => {
    assert.deepEqual(pasteJoints('0,5\t3.25\n\t6\n', cell(0, torque), joints), {
      joints: [
        { joint: 2, torque: 0.5, speed: 3.25 },
        { joint: 1, speed: 6 },
      ],
      problems: [],
      missing: 0,
    });
  });

  it('reads an axis as a word, an angle or a direction', () => {
    assert.deepEqual(
      pasteJoints('yaw\np\n30°', cell(0, axis), joints).joints.map((row) => row.axis),
      [[0, 0, 1], [1, 0, 0], [0.866025, 0, 0.5]],
    );
    assert.deepEqual(pasteJoints('1 0 0,5', cell(0, axis), joints).joints, [{ joint: 2, axis: [1, 0, 0.5] }]);
  });

  it('goes by a row of titles, in any order and with units', () => {
    const text = 'Torque [Nm]\tName\tupper limit\tlower_limit\n1\tneck\t30\t-30\r\n';
    assert.deepEqual(pasteJoints(text, cell(1, torque), joints).joints, [{ joint: 1, name: 'neck', limits: [-30, 30], torque: 1 }]);
  });

  it('keeps the limit that is not pasted', () => {
    assert.deepEqual(pasteJoints('-20', cell(2, lower), joints).joints, [{ joint: 0, limits: [-20, 60] }]);
  });

  it('fills a chosen range with one value', () => {
    const range = rangeOf({ row: 0, column: torque }, { row: 2, column: torque });
    assert.deepEqual(pasteJoints('2', range, joints).joints.map((row) => row.torque), [2, 2, 2]);
  });

  it('takes nothing of a text with one bad cell, and says where it is', () => {
    const result = pasteJoints('name\ttorque\nneck\t1\nknee\tstrong', cell(0, name), joints);
    assert.deepEqual(result, {
      joints: [],
      problems: [{ row: 1, column: torque, reason: "found 'strong', expected a number (row 3, column 2 of the text)" }],
      missing: 0,
    });
  });

  it('says which title it does not know, or has twice', () => {
    const reasons = pasteJoints('name\tmass\tname\na\t1\tb', cell(0, name), joints).problems.map(({ reason }) => reason);
    assert.match(reasons[0] as string, /found 'mass' in the row of titles, column 2, expected name, axis/);
    assert.match(reasons[1] as string, /column 3, expected each column once/);
  });

  it('refuses more columns than there are, and a joint in a file of its own', () => {
    assert.match(pasteJoints('1\t2\t3', cell(0, torque), joints).problems[0]!.reason, /found '3', expected at most 2 columns/);
    const other = [joint('J1', { editable: false })];
    assert.match(pasteJoints('9', cell(0, torque), other).problems[0]!.reason, /J1 is in a file of its own/);
  });

  it('counts the rows for which joints are missing; the new joints come at the head', () => {
    const result = pasteJoints('a\nb\nc\n\n', cell(2, name), joints);
    assert.equal(result.missing, 2);
    assert.deepEqual(result.joints, [
      { joint: 2, name: 'a' },
      { joint: 1, name: 'b' },
      { joint: 0, name: 'c' },
    ]);
    assert.match(pasteJoints('1\n2', cell(2, lower), joints).problems[0]!.reason, /expected both/);
  });
});
