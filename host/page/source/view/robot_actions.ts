// Actions that only a robot on a bus has.
import { signal } from '@preact/signals-core';
import type { Stores } from './robot_view.js';
import type { Action } from '../state/actions.js';
import type { RobotCommand } from '../state/robot_commands.js';

// Whether the 3D view also shows the simulation that runs beside the robot.
export const ghostIsOn = signal(true);

export function toggleGhost(): void {
  ghostIsOn.value = !ghostIsOn.value;
}

// Moves all joints to 0 degrees, or to the limit nearest to it.
export function poseZero({ state, poses }: Stores<'poses' | 'state'>): void {
  const joints = state.robot.value?.joints ?? [];
  const nearest = joints.map(({ lower, upper }, i) => [i, Math.min(upper, Math.max(lower, 0))] as const);
  poses.move(new Map(nearest), joints.length);
}

export function addRobotActions(app: Stores<'actions' | 'operations' | 'poses' | 'state'>): void {
  const { state, operations } = app;
  const isBus = () => state.robot.value?.kind === 'bus';
  const command = (name: RobotCommand, title: string, keys: string[], run: () => void): Action => ({
    id: name,
    title,
    group: 'Robot',
    keys,
    isShown: isBus,
    isEnabled: () => state.obstacleTo(name) === null,
    obstacle: () => state.obstacleTo(name),
    run,
  });
  app.actions.add(
    command('power_on', 'Power on: joints hold', ['O'], () => void operations.tell('power', { on: true })),
    command('power_off', 'Power off: joints ramp to the safe pose first', ['Shift+O'], () => void operations.tell('power', { on: false })),
    command('pose', 'Positions: all joints to 0', [], () => poseZero(app)),
    command('scan', 'Scan the bus again', [], () => void operations.tell('scan', {})),
    {
      id: 'ghost',
      title: '3D view: show the simulation as a ghost, or not',
      group: 'View',
      keys: ['Shift+G'],
      isShown: isBus,
      run: toggleGhost,
    },
  );
}
