// The keys that move a paused robot by hand.
import type { Vector } from '../geometry/quaternion.js';
import type { Action } from '../state/actions.js';
import { openDialog } from './dialogs.js';
import type { Stores } from './robot_view.js';

const moveStep = 0.01; // metres
const turnStep = 5; // degrees
const moveKeys: readonly [key: string, offset: Vector, turn: number][] = [
  ['ArrowLeft', [-moveStep, 0, 0], 0],
  ['ArrowRight', [moveStep, 0, 0], 0],
  ['ArrowUp', [0, moveStep, 0], 0],
  ['ArrowDown', [0, -moveStep, 0], 0],
  ['Shift+ArrowUp', [0, 0, moveStep], 0],
  ['Shift+ArrowDown', [0, 0, -moveStep], 0],
  ['PageUp', [0, 0, 0], turnStep],
  ['PageDown', [0, 0, 0], -turnStep],
];

// They are the robot's keys while Move is on, wherever the focus is, but for text fields.
export function moveActions({ mover, shownPage }: Stores<'mover' | 'shownPage'>): Action[] {
  return moveKeys.map(([key, offset, turn]) => ({
    id: `move_by_${key}`,
    title: turn === 0 ? 'Move the robot by 1 cm' : 'Turn the robot by 5 degrees',
    group: 'Robot',
    keys: [key],
    isShown: () => mover.isActive.value && shownPage.value === 'live' && openDialog.value === 'none',
    isBeforeElements: true,
    run: () => void mover.step(offset, turn),
  }));
}
