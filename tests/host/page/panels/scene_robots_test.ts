import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { sendRobots } from '../../../../host/page/source/panels/scene_robots.js';
import type { ToScene } from '../../../../host/page/source/scene/scene_messages.js';
import type { ComparedView } from '../../../../host/page/source/view/robot_view.js';
import type { RobotDocument } from '../../../../host/page/source/wire/messages.js';
import { pageSignal } from '../support/page_signal.js';

const robotOf = (name: string) => ({ name }) as RobotDocument;

function view(first: RobotDocument | null = robotOf('first')) {
  const robot = pageSignal<RobotDocument | null>(first);
  const wholePath = pageSignal<Float64Array | null>(null);
  const compared = pageSignal<ComparedView | null>(null);
  const sent: string[] = [];
  const note = (message: ToScene) => {
    if (message.kind === 'path') sent.push(`${message.isOfGhost ? 'ghost path' : 'path'} ${message.heads.length}`);
    if (message.kind === 'robot' || message.kind === 'ghost') sent.push(`${message.kind} ${message.robot.name}`);
  };
  const stop = sendRobots({ state: { robot }, wholePath, compared } as never, note);
  const compare = (second: RobotDocument, points: number) => {
    compared.value = { reader: { robot: second, wholePath: pageSignal(new Float64Array(points)) } } as unknown as ComparedView;
  };
  return { robot, wholePath, compared, compare, stop, take: () => sent.splice(0) };
}

describe('the 3D view', () => {
  it('gets a robot, and its path when that is another one', () => {
    const { wholePath, take } = view();
    assert.deepEqual(take(), ['robot first']);
    wholePath.value = new Float64Array(7);
    assert.deepEqual(take(), ['path 7']);
  });

  it('gets the path again with another robot, and so the ghost and its path', () => {
    const { robot, wholePath, compare, take } = view();
    wholePath.value = new Float64Array(7);
    compare(robotOf('second'), 14);
    take();
    robot.value = robotOf('third');
    assert.deepEqual(take(), ['robot third', 'path 7', 'ghost second', 'ghost path 14']);
  });

  it('gets the path of the next ghost without another ghost, if its body is the same', () => {
    const { robot, compare, take } = view();
    const body = robot.value as RobotDocument;
    compare(body, 14);
    assert.deepEqual(take(), ['robot first', 'ghost path 14']);
    compare(body, 21);
    assert.deepEqual(take(), ['ghost path 21']);
  });

  it('forgets the ghost and its path when there is none any more', () => {
    const { robot, compare, compared, take } = view();
    compare(robot.value as RobotDocument, 14);
    take();
    compared.value = null;
    assert.deepEqual(take(), ['ghost path 0']);
    compare(robotOf('second'), 14);
    take();
    compared.value = null;
    assert.deepEqual(take(), ['ghost first', 'ghost path 0']);
  });

  it('gets nothing without a robot, and nothing after its end', () => {
    const { robot, stop, take } = view(null);
    assert.deepEqual(take(), []);
    robot.value = robotOf('first');
    take();
    stop();
    robot.value = robotOf('second');
    assert.deepEqual(take(), []);
  });
});
