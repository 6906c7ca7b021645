import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import {
  actionBinding,
  describeRemote,
  firstBinding,
  parameterBinding,
  parameterNames,
  positionOf,
  readLearned,
  withNumber,
} from '../../../../host/page/source/state/remote_bindings.js';
import type { Parameter, RemoteDocument } from '../../../../host/page/source/wire/messages.js';

const amplitude: Parameter = {
  slot: 1,
  name: 'amplitude',
  unit: 'degree',
  scale: 0.5,
  minimum: 0,
  maximum: 180,
  default: 60,
  help: '',
  internal: false,
  wraps: false,
  joints: [0],
  file: [60],
  wanted: [60],
  confirmed: [60],
  tick: [0],
};

const remote: RemoteDocument = {
  devices: [{ id: 3, name: 'Pad', elements: [{ name: 'ABS_X', kind: 'axis' }] }],
  bindings: [],
  problems: [],
  learning: false,
  active: true,
  file: 'robot.remote.json',
  saved: true,
};

describe('a new binding', () => {
  it('lets an axis move the first parameter over its whole range', () => {
    assert.deepEqual(firstBinding({ device: 'Pad', name: 'ABS_X', kind: 'axis' }, [amplitude]), {
      device: 'Pad',
      element: 'ABS_X',
      parameters: ['1.amplitude'],
      method: 'linear',
      lower: 0,
      upper: 90,
      step: 0.5,
      dead_zone: 0,
      curve: 1,
      take_up: true,
    });
  });

  it('lets a button run the robot while it is held', () => {
    const button = { device: 'Pad', name: 'BTN_SOUTH', kind: 'button' } as const;
    assert.deepEqual(firstBinding(button, [amplitude]), { device: 'Pad', element: 'BTN_SOUTH', action: 'hold_to_run' });
  });

  it('has a whole turn for an angle without limits', () => {
    const { lower, upper } = parameterBinding({ device: 'Pad', element: 'ABS_X' }, { ...amplitude, wraps: true });
    assert.deepEqual([lower, upper], [-180, 180]);
  });
});

describe('an edited binding', () => {
  const bound = parameterBinding({ device: 'Pad', element: 'ABS_X' }, amplitude);

  it('takes numbers, also with a comma', () => {
    assert.deepEqual(withNumber(bound, 'upper', ' 45,5'), { ...bound, upper: 45.5 });
  });

  it('says what is wrong with another text', () => {
    assert.equal(withNumber(bound, 'step', 'x'), "found 'x', expected a number");
  });

  it('takes several parameters', () => {
    assert.deepEqual(parameterNames(' 1.amplitude, 2.delay:J2 '), ['1.amplitude', '2.delay:J2']);
  });

  it('forgets its parameters when it becomes an action', () => {
    assert.deepEqual(actionBinding(bound, 'stop'), { device: 'Pad', element: 'ABS_X', action: 'stop' });
  });
});

describe('what the program says of a remote control', () => {
  it('has the learned element', () => {
    assert.deepEqual(readLearned({ device: 'Pad', element: 'ABS_X', kind: 'axis' }), { device: 'Pad', name: 'ABS_X', kind: 'axis' });
    assert.equal(readLearned(null), null);
    assert.equal(readLearned({ device: 3 }), null);
  });

  it('has positions of devices that are there', () => {
    const values = { devices: [{ id: 3, positions: [0.5] }], bindings: [] };
    assert.equal(positionOf(values, 3, 0), 0.5);
    assert.equal(positionOf(values, 4, 0), null);
    assert.equal(positionOf(null, 3, 0), null);
  });

  it('is one line', () => {
    assert.equal(describeRemote(null), 'no device');
    assert.equal(describeRemote(remote), 'Pad');
    assert.equal(describeRemote({ ...remote, active: false }), 'Pad; no effect: nobody drives');
  });
});
