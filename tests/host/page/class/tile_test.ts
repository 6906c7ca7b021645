import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { groupsOf, matching } from '../../../../host/page/source/class/projects.js';
import type { TileSession } from '../../../../host/page/source/class/tile_messages.js';
import { inOrder } from '../../../../host/page/source/class/tile_order.js';
import {
  codeText,
  collectText,
  countText,
  distanceText,
  isOnlyHere,
  linkForLearners,
  seatAddress,
  speedText,
  tileProblem,
  tileState,
} from '../../../../host/page/source/class/tile_text.js';
import type { ClassSeat } from '../../../../host/page/source/wire/class_messages.js';

const seat = (number: number, more: Partial<ClassSeat> = {}): ClassSeat => ({
  seat: number,
  name: `learner ${number}`,
  state: 'ready',
  problem: null,
  connections: 2,
  path: `/robots/${number}/`,
  token: 'secret',
  recordings: 0,
  ...more,
});
const session = (more: Partial<TileSession> = {}): TileSession => ({
  state: 'running',
  speed: 0.056,
  distance: 0.57,
  servoProblem: null,
  failure: null,
  isRecording: false,
  ...more,
});

describe('the order of tiles', () => {
  const learners = [seat(3, { name: 'bea' }), seat(1, { name: 'Carl 10' }), seat(2, { name: 'Anna' }), seat(4, { name: 'Carl 9' })];
  const seatsIn = (order: 'name' | 'seat' | 'speed', speeds = new Map<number, number | null>()) => inOrder(learners, order, speeds).map((one) => one.seat);

  it('is by name as people sort, or by seat', () => {
    assert.deepEqual(seatsIn('name'), [2, 3, 4, 1]);
    assert.deepEqual(seatsIn('seat'), [1, 2, 3, 4]);
  });

  it('shows who is fastest; who has no speed comes last, by seat', () => {
    assert.deepEqual(seatsIn('speed', new Map([[3, 0.02], [2, 0.05], [1, null], [4, 0]])), [2, 3, 4, 1]);
    assert.deepEqual(seatsIn('speed'), [1, 2, 3, 4]);
  });
});

describe('a tile', () => {
  it('says how the robot is', () => {
    assert.equal(tileState(seat(1), session()).text, 'runs');
    assert.equal(tileState(seat(1), session({ state: 'paused' })).text, 'paused');
    assert.equal(tileState(seat(1), session({ state: 'stopped' })).kind, 'stopped');
    assert.equal(tileState(seat(1), session({ state: 'failed' })).text, 'failed');
    assert.equal(tileState(seat(1), null).text, 'connecting');
    assert.equal(tileState(seat(1, { state: 'starting' }), session()).text, 'starting');
    assert.equal(tileState(seat(1, { state: 'ended' }), session()).text, 'ended');
  });

  it('says that nobody is there, and that the robot runs all the same', () => {
    assert.deepEqual(tileState(seat(1, { connections: 0 }), session({ state: 'paused' })), { text: 'not there', kind: 'absent' });
    assert.deepEqual(tileState(seat(1, { connections: 0 }), session({ state: 'stopped' })), { text: 'not there, robot STOPPED', kind: 'stopped' });
    assert.deepEqual(tileState(seat(1, { connections: 0 }), session()), { text: 'not there, robot runs', kind: 'running' });
    assert.equal(tileState(seat(0, { connections: 0 }), session()).text, 'runs', 'of the teacher');
  });

  it('has the most important problem', () => {
    assert.equal(tileProblem(seat(1), session()), null);
    assert.equal(tileProblem(seat(1), session({ servoProblem: 'too fast' })), 'too fast');
    assert.equal(tileProblem(seat(1), session({ servoProblem: 'too fast', failure: 'unstable' })), 'unstable');
    assert.equal(tileProblem(seat(1, { state: 'ended', problem: 'it was killed' }), session()), 'it was killed');
    assert.equal(tileProblem(seat(1, { state: 'ended' }), null), 'The program of this robot does not run.');
  });

  it('has figures with units', () => {
    assert.deepEqual([speedText(0.0561), speedText(null), speedText(undefined)], ['56 mm/s', '–', '–']);
    assert.deepEqual([distanceText(1.234), distanceText(null)], ['1.23 m', '–']);
  });

  it('opens a robot of a learner to look, and that of the teacher to drive', () => {
    assert.equal(seatAddress(seat(3)), '/robots/3/?look#secret');
    assert.equal(seatAddress(seat(0)), '/robots/0/#secret');
    assert.equal(seatAddress(seat(0), 'recordings'), '/robots/0/#secret&recordings');
  });
});

describe('the class', () => {
  it('counts learners, and those who are there', () => {
    const learners = [seat(1), seat(2, { connections: 0 }), seat(3, { state: 'ended' })];
    assert.equal(countText({ learners, limit: 12 }), '3 of 12 learners, 1 there');
  });

  it('has a way in that can be read aloud', () => {
    assert.equal(codeText('482913'), '482 913');
    assert.equal(linkForLearners({ address: 'https://room.local:8443/', code: '482913' }), 'https://room.local:8443/#join=482913');
  });

  it('says whether other computers reach it', () => {
    for (const address of ['http://127.0.0.1:8443/', 'http://localhost/', 'https://[::1]:8443/']) assert.equal(isOnlyHere(address), true, address);
    for (const address of ['https://room.local:8443/', 'https://192.168.1.5/', 'https://localhost.org/']) assert.equal(isOnlyHere(address), false, address);
  });

  it('says what became of the recordings', () => {
    const text = (copied: number, known: number, running: number) => collectText({ copied, known, running, failed: [] });
    assert.equal(text(7, 3, 1), '7 recordings copied, 3 were there, 1 still runs.');
    assert.equal(text(1, 1, 2), '1 recording copied, 1 was there, 2 still run.');
    assert.equal(text(0, 2, 0), '0 recordings copied, 2 were there.');
    assert.equal(text(0, 0, 0), 'There are no recordings yet.');
  });
});

describe('what can be handed out', () => {
  const wave = { file: 'a/wave.simulation.xml', group: 'Gaits', title: 'Wave', text: 'It crawls forward.' };
  const mine = { file: 'mine/x.simulation.xml', group: 'My project', title: 'x', text: '' };
  const roll = { file: 'a/roll.simulation.xml', group: 'Gaits', title: 'Roll', text: '' };

  it('is found by words in any order and case', () => {
    assert.deepEqual(matching([wave, mine, roll], 'FORWARD gaits'), [wave]);
    assert.deepEqual(matching([wave, mine, roll], ' '), [wave, mine, roll]);
    assert.deepEqual(matching([wave, mine, roll], 'stairs'), []);
  });

  it('stands below its heading', () => {
    assert.deepEqual(groupsOf([mine, wave, roll]), [['My project', [mine]], ['Gaits', [wave, roll]]]);
  });
});
