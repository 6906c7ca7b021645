import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { hasFreshModules, moduleRows, nodeList, refText, serialText } from '../../../../host/page/source/modules/module_rows.js';
import { sensorsOf, stateText, touchText, troubleOf } from '../../../../host/page/source/modules/row_text.js';
import type { BusModule, ModulesDocument, ScannedNode } from '../../../../host/page/source/wire/messages.js';

const live = (node: number, words: Partial<BusModule> = {}): BusModule => ({
  node,
  joint: null,
  state: 'Pre-operational',
  drive: 'no power',
  angle: 1,
  current: 10,
  current_limit: 2000,
  temperature: 25,
  fault: null,
  advice: null,
  silent: false,
  stop_confirmed: null,
  contacts: 0,
  ...words,
});

const found = (node: number, words: Partial<ScannedNode> = {}): ScannedNode => ({ node, answers: true, state: null, serial: 100 + node, error_register: 0, ...words });

const documentOf = (nodes: ScannedNode[], serial: number | null = null): Pick<ModulesDocument, 'found' | 'robot'> => ({
  found: { nodes },
  robot: {
    document: 'robot',
    name: 'caterpillar',
    joints: [
      { name: 'J1', node: 4, serial },
      { name: 'J2', node: 3, serial: null },
    ],
  },
});

describe('the rows of the table of modules', () => {
  it('join what is live, what was found and the joints of the robot, by node ids', () => {
    const rows = moduleRows([live(9), live(3)], documentOf([found(3), found(4)]));
    assert.deepEqual(
      rows.map(({ node, serial, joint }) => [node, serial, joint?.name ?? null]),
      [
        [3, 103, 'J2'],
        [4, 104, 'J1'],
        [9, null, null],
      ],
    );
  });

  it('say which module is not the one that the file of the robot names', () => {
    const [first] = moduleRows([], documentOf([found(4)], 77));
    assert.equal(first?.isOtherModule, true);
    assert.match(troubleOf(first!)?.text ?? '', /another module for J1/);
    assert.equal(moduleRows([], documentOf([found(4)], 104))[0]?.isOtherModule, false);
  });

  it('have four sensors at the head, and two elsewhere', () => {
    const rows = moduleRows([live(3, { contacts: 0b10 }), live(4, { contacts: 0b1001 }), live(5, { contacts: 0b100 })], documentOf([]));
    assert.deepEqual(rows.map(sensorsOf), [[0, 1], [0, 1, 2, 3], [0, 1, 2, 3]]);
    assert.deepEqual(rows.map(touchText), ['pressed: front', 'pressed: rear; front, link in front', 'pressed: rear, link in front']);
  });

  it('name trouble: a fault with what to do, silence, no answer, an error', () => {
    const troubled = moduleRows(
      [live(1, { fault: 'over-current', advice: 'Look for what blocks the joint.' }), live(2, { silent: true }), live(3)],
      documentOf([found(3), found(5, { answers: false }), found(6, { error_register: 2 })]),
    );
    assert.deepEqual(
      troubled.map((row) => troubleOf(row)?.text ?? null),
      ['over-current', 'silent', null, 'does not answer', 'error register 2'],
    );
    assert.equal(troubleOf(troubled[0]!)?.advice, 'Look for what blocks the joint.');
    assert.deepEqual(troubled.map(stateText), ['Pre-operational', 'silent', 'Pre-operational', 'no answer', 'not driven']);
  });

  it('say of a module that nobody asks during a job neither that it is silent nor what it touches', () => {
    const module = live(3, { silent: true, contacts: 3 });
    const during = moduleRows([module], documentOf([]), { knowsSilence: false, readsTouch: false })[0]!;
    assert.deepEqual([troubleOf(during), touchText(during)], [null, 'not read']);
    assert.equal(troubleOf(moduleRows([module], documentOf([]))[0]!)?.text, 'silent');
  });

  it('know of modules without a node id, in either form', () => {
    assert.equal(hasFreshModules({ found: null }), false);
    assert.equal(hasFreshModules({ found: { nodes: [], fresh_modules: true } }), true);
    assert.equal(hasFreshModules({ found: { nodes: [], modules_without_node_id: true } }), true);
  });
});

describe('a module', () => {
  it('has a serial number of eight digits, and without a node id no other name', () => {
    assert.equal(serialText(0x1a2b3), '0x0001A2B3');
    assert.equal(refText({ node: 3, serial: 1 }), 'node 3');
    assert.equal(refText({ node: 0, serial: 0x75fa142d }), 'the module 0x75FA142D');
    assert.equal(nodeList(new Set([11, 3])), '3,11');
  });
});
