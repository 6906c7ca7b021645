import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { obstacleTo, type RobotCommand, type RobotSituation } from '../../../../host/page/source/state/robot_commands.js';
import type { BusSession } from '../../../../host/page/source/wire/messages.js';

const commands: readonly RobotCommand[] = ['power_on', 'power_off', 'run', 'hold', 'pose', 'record', 'scan'];

function situation(state: BusSession['state'], fields: Partial<RobotSituation> = {}): RobotSituation {
  return {
    isConnected: true,
    isHolder: true,
    session: { state, recording: null },
    bus: { connected: true, other_host: false },
    ...fields,
  };
}

const possible = (now: RobotSituation) => commands.filter((command) => obstacleTo(command, now) === null);

describe('the commands of a robot on a bus', () => {
  // The table of states in docs/page-interface.md.
  const table: [BusSession['state'], RobotCommand[]][] = [
    ['off', ['power_on', 'run', 'record', 'scan']],
    ['starting', ['power_off']],
    ['held', ['power_off', 'run', 'pose']],
    ['running', ['power_off', 'hold']],
    ['stopping', []],
    ['failed', ['scan']],
  ];

  for (const [state, expected] of table) {
    it(`in the state ${state} are ${expected.join(', ') || 'none'}`, () => {
      assert.deepEqual(possible(situation(state)), expected);
    });
  }

  it('need control, but for a scan', () => {
    assert.deepEqual(possible(situation('off', { isHolder: false })), ['scan']);
    assert.equal(obstacleTo('run', situation('off', { isHolder: false })), 'Take control first (C).');
  });

  it('need the connection to the program', () => {
    assert.deepEqual(possible(situation('held', { isConnected: false })), []);
  });

  it('need the bus, but for power off', () => {
    const bus = { connected: false, other_host: false };
    assert.deepEqual(possible(situation('held', { bus })), ['power_off']);
    assert.deepEqual(possible(situation('off', { bus })), []);
  });

  it('give no power while another host drives modules', () => {
    assert.deepEqual(possible(situation('off', { bus: { connected: true, other_host: true } })), ['record', 'scan']);
  });

  it('say why they are not possible', () => {
    for (const [state] of table) {
      for (const command of commands) {
        const obstacle = obstacleTo(command, situation(state));
        assert.ok(obstacle === null || /^[A-Z].*\.$/.test(obstacle), `${command} in ${state}: found '${obstacle}'`);
      }
    }
    assert.equal(obstacleTo('pose', situation('running')), 'Hold first.');
    assert.equal(obstacleTo('pose', situation('off')), 'Power on first.');
  });

  it('end a recording in every state', () => {
    assert.equal(obstacleTo('record', situation('running', { session: { state: 'running', recording: 'a.proleg' } })), null);
  });
});
