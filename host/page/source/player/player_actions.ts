// The actions of the player, with their keys.
import { openDialog } from '../view/dialogs.js';
import { sharedActions } from '../view/shared_actions.js';
import type { PlayedRecording, PlayerApp } from './player_app.js';

// Adds the actions of a time line. `playKeys`: Space plays only if there is no robot to stop.
export function addPlaybackActions({ actions, time, tickRate }: PlayedRecording, playKeys: readonly string[]): void {
  const step = (id: string, title: string, key: string, ticks: number) => ({
    id,
    title,
    group: 'Recording' as const,
    keys: [key],
    run: () => time.step(ticks),
  });
  actions.add(
    { id: 'play', title: 'Play, or pause', group: 'Recording', keys: playKeys, run: () => time.toggle() },
    step('tick_back', 'One tick back', 'ArrowLeft', -1),
    step('tick_on', 'One tick on', 'ArrowRight', 1),
    step('second_back', 'One second back', 'Shift+ArrowLeft', -tickRate),
    step('second_on', 'One second on', 'Shift+ArrowRight', tickRate),
    { id: 'start', title: 'To the start', group: 'Recording', keys: ['Home'], run: () => time.seek(time.first) },
    { id: 'end', title: 'To the end', group: 'Recording', keys: ['End'], run: () => time.seek(time.last) },
    { id: 'slower', title: 'Slower', group: 'Recording', keys: ['-'], run: () => time.slower() },
    { id: 'faster', title: 'Faster', group: 'Recording', keys: ['+'], run: () => time.faster() },
    {
      id: 'whole_run',
      title: 'Strip and plots: the whole run',
      group: 'View',
      keys: ['W'],
      run: () => void (time.part.value = null),
    },
  );
}

export function addPlayerActions(app: PlayerApp): void {
  addPlaybackActions(app, ['Space', 'K']);
  app.actions.add(
    ...sharedActions,
    {
      id: 'close',
      title: 'Close this window',
      group: 'Page',
      keys: ['Escape'],
      isGlobal: true,
      run: () => void (openDialog.value = 'none'),
    },
  );
}
