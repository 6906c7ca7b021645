// Power, gait and hold of a robot on a bus; the present tick and time; the reason of the last stop.
import type { Stores } from '../../view/robot_view.js';
import { recordOrEnd } from '../../view/page_actions.js';
import { pauseIcon, powerIcon, recordIcon, runIcon } from '../icons.js';
import { TickCounter } from '../tick_counter.js';
import { CommandButton } from './command_button.js';
import { TroubleList } from './trouble_list.js';

// Texts by state: the activity of the robot, and the next step of the user.
const hints = {
  off: 'The servos have no power. Power on to move joints, or run the gait.',
  starting: 'The modules are set up and get power. Joints that measure their angle stay, or go slowly to the start.',
  held: 'The joints hold. Move them below, or run the gait.',
  running: 'The joints follow the gait.',
  stopping: 'The joints go to the safe pose, then the servos lose their power.',
  failed: 'The session has failed: start proleg ui again.',
} as const;

export function RobotControls({ app }: { app: Stores<'newestTick' | 'operations' | 'state' | 'tickRate'> }) {
  const { state, operations } = app;
  const session = state.busSession.value;
  if (session === null) {
    return null;
  }
  const isOff = session.state === 'off';
  const obstacle = isOff ? state.obstacleTo('power_on') : null;
  const { recording, stopped_by: stoppedBy } = session;
  return (
    <section class="run-controls" aria-label="Robot">
      <CommandButton
        app={app}
        command="power_on"
        isPrimary
        run={() => void operations.tell('power', { on: true })}
        title="The servos get power and the joints hold. No joint moves that measures its angle. (O)"
      >
        {powerIcon} Power on
      </CommandButton>
      <CommandButton
        app={app}
        command="power_off"
        run={() => void operations.tell('power', { on: false })}
        title="The joints go to the safe pose, then the servos lose their power (Shift + O)"
      >
        {powerIcon} Power off
      </CommandButton>
      <CommandButton
        app={app}
        command="run"
        isPrimary={!isOff}
        run={() => void operations.tell('run', {})}
        title={isOff ? 'Power, then the gait from tick 0 (K)' : 'The joints go slowly to the gait, then follow it (K)'}
      >
        {runIcon} Run gait
      </CommandButton>
      <CommandButton
        app={app}
        command="hold"
        isPrimary
        run={() => void operations.tell('pause', {})}
        title="The joints hold where they are (K)"
      >
        {pauseIcon} Hold
      </CommandButton>
      <CommandButton
        app={app}
        command="record"
        isPressed={recording !== null}
        run={() => recordOrEnd(app)}
        title={
          recording === null
            ? 'Records the next run, from its tick 0 to its end or its first hold (R)'
            : `Ends the recording ${recording} (R)`
        }
      >
        {recordIcon} {recording === null ? 'Record the next run' : isOff ? 'Will record' : 'Recording'}
      </CommandButton>
      <TickCounter app={app} />
      <span class="hint" data-testid="robot-hint">
        {state.isLookingOn.value
          ? 'You look on. Take control to drive the robot.'
          : `${obstacle ?? hints[session.state]}${isOff && session.stopped_by ? ` Stopped by: ${stoppedBy}.` : ''}`}
      </span>
      <TroubleList app={app} />
    </section>
  );
}
