// Words for joints, and the order of a chain.
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { algorithmTitle, axisAngle, axisLetter, axisOfAngle, axisWord, engineText, fromTail } from '../../../../host/page/source/state/robot_text.js';
import { namedJoints } from '../../../../host/page/source/state/named_joints.js';

describe('the axis of a joint', () => {
  it('is pitch, yaw or an angle between them', () => {
    assert.equal(axisLetter([1, 0, 0]), 'p');
    assert.equal(axisLetter([0, 0, 2]), 'y');
    assert.equal(axisLetter([Math.cos(Math.PI / 6), 0, Math.sin(Math.PI / 6)]), '30°');
    assert.equal(axisLetter([-1, 0, 0]), '180°');
    assert.equal(axisWord([0, 0, 1]), 'yaw: to the sides');
  });

  it('has no angle if it is not across the robot', () => {
    assert.equal(axisAngle([0, 1, 0]), null);
    assert.equal(axisAngle([0, 0, 0]), null);
    assert.equal(axisLetter([1, 1, 0]), '…');
  });

  it('comes back from its angle', () => {
    for (let angle = -179; angle <= 180; angle += 1) {
      assert.ok(Math.abs((axisAngle(axisOfAngle(angle)) as number) - angle) < 1e-3, `${angle}`);
    }
    assert.deepEqual(axisOfAngle(90), [0, 0, 1]);
  });
});

describe('the order of a chain', () => {
  it('is shown from the tail', () => {
    assert.deepEqual(fromTail(3), [2, 1, 0]);
  });
});

describe('the name of an algorithm', () => {
  it('is without what all names have', () => {
    assert.equal(algorithmTitle('PatternGenerator_sinusoidal_extended'), 'sinusoidal extended');
    assert.equal(algorithmTitle('DirectJointAccess'), 'DirectJointAccess');
  });
});

describe('texts about a robot', () => {
  it('name the engine that has computed something, and that of the run if it is another one', () => {
    assert.equal(engineText('reduced', 'ode'), 'by the reduced engine; Run has ODE');
    assert.equal(engineText('ode', 'ode'), 'by ODE');
  });

  it('have the name of a joint in place of its number', () => {
    const joints = ['J8', 'J7', 'J6'].map((name) => ({ name }));
    assert.equal(namedJoints('found no end after 1 s in the algorithm mine, joint 1 (0 is at the head)', joints), 'found no end after 1 s in the algorithm mine, J7');
    assert.equal(namedJoints('joint 9 (0 is at the head)', joints), 'joint 9 (0 is at the head)');
  });
});
