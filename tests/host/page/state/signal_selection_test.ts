import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { SignalSelection } from '../../../../host/page/source/state/signal_selection.js';
import { makeSignal } from '../support/telemetry.js';

const line = (index: number) => ({ signal: 'torque', index });

describe('the selection of signals', () => {
  it('holds at most eight lines in a group', () => {
    const selection = new SignalSelection();
    const group = selection.groups.value[0]?.number ?? 0;
    for (let i = 0; i < 12; i += 1) {
      selection.toggle(group, line(i));
    }
    assert.equal(selection.groups.value[0]?.lines.length, 8);
  });

  it('removes a line that is there', () => {
    const selection = new SignalSelection();
    selection.toggle(1, line(3));
    selection.toggle(1, line(3));
    assert.deepEqual(selection.groups.value[0]?.lines, [{ signal: 'angle', index: 0 }]);
  });

  it('numbers groups anew after one was removed', () => {
    const selection = new SignalSelection();
    selection.addGroup();
    selection.removeGroup(2);
    selection.addGroup();
    assert.deepEqual(selection.groups.value.map((group) => group.number), [1, 3]);
  });

  it('needs what strip, plots, table and 3D view show, if the robot has it', () => {
    const selection = new SignalSelection();
    selection.strip.value = '1/current_phase';
    selection.toggle(1, { signal: 'force', index: 0 });
    const signals = ['setpoint', 'angle', 'pulse', 'force', 'contact', 'head', '1/current_phase', '1/other'].map((name) => makeSignal(name, 1));
    assert.deepEqual(
      selection.needed(signals).map((signal) => signal.name),
      ['setpoint', 'angle', 'force', 'contact', 'head', '1/current_phase'],
    );
  });
});
