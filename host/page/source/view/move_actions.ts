// The keys that move a paused robot by hand.
import type { Vector } from '../geometry/quaternion.js';
import type { Action } from '../state/actions.js';
import { openDialog } from './dialogs.js';
import type { Stores } from './robot_view.js';

const moveStep = 0.01; // metres
const turnStep = 5; // degrees
const moveKeys: readonly [key: string, title: string, offset: Vector, turn: number][] = [
  ['ArrowLeft', '1 cm against x', [-moveStep, 0, 0], 0],
  ['ArrowRight', '1 cm along x', [moveStep, 0, 0], 0],
  ['ArrowUp', '1 cm along y', [0, moveStep, 0], 0],
  ['ArrowDown', '1 cm against y', [0, -moveStep, 0], 0],
  ['Shift+ArrowUp', '1 cm up', [0, 0, moveStep], 0],
  ['Shift+ArrowDown', '1 cm down', [0, 0, -moveStep], 0],
  ['PageUp', '5 degrees to the left', [0, 0, 0], turnStep],
  ['PageDown', '5 degrees to the right', [0, 0, 0], -turnStep],
];

// They are the robot's keys while Move is on, wherever the focus is, but for text fields.
export function moveActions({ mover, shownPage }: Stores<'mover' | 'shownPage'>): Action[] {
  return moveKeys.map(([key, title, offset, turn]) => ({
    id: `move_by_${key}`,
    title: `Move the robot ${title}`,
    group: 'Robot',
    keys: [key],
    isShown: () => mover.isActive.value && shownPage.value === 'live' && openDialog.value === 'none',
    isBeforeElements: true,
    run: () => void mover.step(offset, turn),
  }));
}
