// The actions of the page, with their keys.
import { recordingName } from '../state/recording_name.js';
import { toggleDialog } from './dialogs.js';
import { pressEscape } from './front.js';
import { moveActions } from './move_actions.js';
import type { PageState } from '../state/page_state.js';
import type { PageStores, Stores } from './robot_view.js';
import { sharedActions } from './shared_actions.js';

export function recordOrEnd({ state, operations }: Stores<'operations' | 'state'>): void {
  const isRecording = (state.session.value?.recording ?? null) !== null;
  const file = isRecording ? null : recordingName(state.robot.value?.file ?? 'run', new Date());
  void operations.tell('record', { file });
}

// The reason why a robot on a bus can neither start nor hold its gait now; null: it can.
function runObstacle(state: PageState): string | null {
  return state.obstacleTo(state.busSession.value?.state === 'running' ? 'hold' : 'run');
}

export function addActions(app: PageStores): void {
  const { state, time, marks, operations } = app;
  const isHolder = () => state.isHolder.value;
  const isSimulation = () => state.robot.value?.kind !== 'bus';
  const isRunning = () => state.session.value?.state === 'running';
  const tell: typeof operations.tell = (name, parameters) => operations.tell(name, parameters);

  const hasCursorKeys = () => !app.mover.isActive.value;
  const moveCursor = (ticks: number) => {
    marks.pause();
    time.moveCursor(ticks, app.newestTick);
  };

  app.actions.add(
    ...moveActions(app),
    {
      id: 'stop',
      get title() {
        return isSimulation() ? 'STOP the robot, outside text fields' : 'STOP the robot, outside text fields (Esc: also in them)';
      },
      group: 'Robot',
      keys: ['Space'],
      run: () => app.stop.press(),
    },
    {
      id: 'escape',
      title: 'Close what is in front; else pause, or STOP without control',
      group: 'Robot',
      keys: ['Escape'],
      isShown: isSimulation,
      run: () => pressEscape(app),
    },
    {
      id: 'run_or_pause',
      title: 'Run, or pause: hold',
      group: 'Robot',
      keys: ['K'],
      isEnabled: () => (isSimulation() ? isHolder() : runObstacle(state) === null),
      obstacle: () => (isSimulation() ? null : runObstacle(state)),
      run: () => void tell(isRunning() ? 'pause' : 'run', {}),
    },
    {
      id: 'step',
      title: 'Step: one tick, then pause',
      group: 'Robot',
      keys: ['.'],
      isEnabled: isHolder,
      isShown: isSimulation,
      run: () => void tell('step', { ticks: 1 }),
    },
    {
      id: 'move_robot',
      title: 'Move the robot by hand, while paused, or end that',
      group: 'Robot',
      keys: ['G'],
      isEnabled: () => app.mover.isPossible.value,
      isShown: isSimulation,
      run: () => (app.mover.isOn.value = !app.mover.isOn.value),
    },
    {
      id: 'restart',
      title: 'Restart at tick 0',
      group: 'Robot',
      keys: ['Shift+R'],
      isEnabled: isHolder,
      isShown: isSimulation,
      run: () => void tell('restart', {}),
    },
    {
      id: 'restart_as_file',
      title: 'Restart with the parameters of the file',
      group: 'Robot',
      keys: [],
      isEnabled: isHolder,
      isShown: isSimulation,
      run: () => void tell('restart', { parameters: 'file' }),
    },
    {
      id: 'record',
      title: 'Record the run from tick 0 on, or end the recording',
      group: 'Robot',
      keys: ['R'],
      isEnabled: () => (isSimulation() ? isHolder() : state.obstacleTo('record') === null),
      obstacle: () => (isSimulation() ? null : state.obstacleTo('record')),
      run: () => recordOrEnd(app),
    },
    {
      id: 'take_control',
      title: 'Take control, or give it up',
      group: 'Robot',
      keys: ['C'],
      isEnabled: () => state.isConnected.value,
      run: () => void tell(isHolder() ? 'control.release' : 'control.take', {}),
    },
    {
      id: 'freeze',
      title: 'Freeze the view, or return to live',
      group: 'View',
      keys: ['P'],
      run: () => (time.isLive.value ? time.freeze(app.newestTick) : time.goLive()),
    },
    { id: 'live', title: 'Return to live', group: 'View', keys: ['L'], run: () => time.goLive() },
    {
      id: 'tick_back',
      title: 'Time cursor: one tick back',
      group: 'View',
      keys: ['ArrowLeft'],
      isShown: hasCursorKeys,
      run: () => moveCursor(-1),
    },
    {
      id: 'tick_on',
      title: 'Time cursor: one tick on',
      group: 'View',
      keys: ['ArrowRight'],
      isShown: hasCursorKeys,
      run: () => moveCursor(1),
    },
    {
      id: 'second_back',
      title: 'Time cursor: one second back',
      group: 'View',
      keys: ['Shift+ArrowLeft'],
      isShown: hasCursorKeys,
      run: () => moveCursor(-app.tickRate),
    },
    {
      id: 'second_on',
      title: 'Time cursor: one second on',
      group: 'View',
      keys: ['Shift+ArrowRight'],
      isShown: hasCursorKeys,
      run: () => moveCursor(app.tickRate),
    },
    { id: 'mark', title: 'Set a marker at the time cursor', group: 'View', keys: ['M'], run: () => marks.mark(app.newestTick) },
    {
      id: 'loop_start',
      title: 'Loop: begin at the time cursor',
      group: 'View',
      keys: ['['],
      run: () => marks.setLoopStart(app.newestTick),
    },
    {
      id: 'loop_end',
      title: 'Loop: end at the time cursor',
      group: 'View',
      keys: [']'],
      run: () => marks.setLoopEnd(app.newestTick),
    },
    {
      id: 'loop_play',
      title: 'Loop: play, or pause',
      group: 'View',
      keys: ['Shift+P'],
      isEnabled: () => marks.range.value !== null,
      run: () => marks.playOrPause(app.newestTick),
    },
    { id: 'loop_remove', title: 'Loop: remove', group: 'View', keys: [], run: () => marks.removeLoop() },
    {
      id: 'undo',
      title: 'Undo the last change of parameters',
      group: 'Parameters',
      keys: ['Ctrl+Z'],
      isGlobal: true,
      isEnabled: isHolder,
      run: () => void tell('undo', {}),
    },
    {
      id: 'redo',
      title: 'Redo',
      group: 'Parameters',
      keys: ['Ctrl+Y', 'Ctrl+Shift+Z'],
      isGlobal: true,
      isEnabled: isHolder,
      run: () => void tell('redo', {}),
    },
    {
      id: 'swap',
      title: 'Swap the sets A and B',
      group: 'Parameters',
      keys: ['B'],
      isEnabled: isHolder,
      isShown: isSimulation,
      run: () => void tell('swap', {}),
    },
    {
      id: 'reset',
      title: 'All parameters back to the file',
      group: 'Parameters',
      keys: [],
      isEnabled: isHolder,
      run: () => void tell('reset', {}),
    },
    {
      id: 'command_line',
      title: 'Command that gives the same run',
      group: 'Parameters',
      keys: ['X'],
      isShown: isSimulation,
      run: () => toggleDialog('command_line'),
    },
    { id: 'live_page', title: 'Page Live', group: 'Page', keys: ['1'], run: () => void (app.shownPage.value = 'live') },
    {
      id: 'recordings_page',
      title: 'Page Recordings',
      group: 'Page',
      keys: ['2'],
      run: () => void (app.shownPage.value = 'recordings'),
    },
    {
      id: 'make_page',
      title: 'Page Make',
      group: 'Page',
      keys: ['3'],
      isShown: () => state.hasMake.value,
      run: () => void (app.shownPage.value = 'make'),
    },
    {
      id: 'modules_page',
      title: 'Page Modules',
      group: 'Page',
      keys: ['4'],
      isShown: () => state.hasModules.value,
      run: () => void (app.shownPage.value = 'modules'),
    },
    {
      id: 'value_table',
      title: 'Table of all values: copy and paste as in a spreadsheet',
      group: 'Parameters',
      keys: ['V'],
      run: () => toggleDialog('value_table'),
    },
    {
      id: 'apply_to_file',
      title: 'Apply to file: write the values of parameters',
      group: 'Parameters',
      keys: ['W'],
      isShown: isSimulation,
      run: () => toggleDialog('file_diff'),
    },
    ...sharedActions,
  );
}
