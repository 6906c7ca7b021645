// What can be done with a robot on a bus now, and if not, why. Buttons, keys and palette ask the same question.
import type { BusDocument, BusSession } from '../wire/messages.js';

export type RobotCommand = 'power_on' | 'power_off' | 'run' | 'hold' | 'pose' | 'record' | 'scan';

type State = BusSession['state'];

export interface RobotSituation {
  isConnected: boolean; // whether the page is connected to the program
  isHolder: boolean;
  session: Pick<BusSession, 'state' | 'recording'> | null;
  bus: Pick<BusDocument, 'connected' | 'other_host'> | null;
}

const allowed: Record<RobotCommand, readonly State[]> = {
  power_on: ['off'],
  power_off: ['starting', 'held', 'running'],
  run: ['off', 'held'],
  hold: ['running'],
  pose: ['held'],
  record: ['off'],
  scan: ['off', 'failed'],
};

// The commands that switch the power on.
const starts: readonly RobotCommand[] = ['power_on', 'run'];

// Why a command is not possible in a state in which it is not allowed.
function stateObstacle(command: RobotCommand, state: State): string {
  switch (state) {
    case 'starting':
      return 'Wait until the robot has started.';
    case 'stopping':
      return 'Wait until the servos have lost their power.';
    case 'failed':
      return 'The session has failed: start proleg ui again.';
    case 'off':
      return command === 'pose' ? 'Power on first.' : 'The servos have no power.';
    case 'held':
      return command === 'hold' ? 'The gait does not run.' : 'Power off first.';
    case 'running':
      return command === 'pose' ? 'Hold first.' : command === 'run' ? 'The gait runs.' : 'Power off first.';
  }
}

// The reason why a command is not possible; null: it is possible.
export function obstacleTo(command: RobotCommand, { isConnected, isHolder, session, bus }: RobotSituation): string | null {
  if (!isConnected || session === null) {
    return 'No connection to the program.';
  }
  if (!isHolder && command !== 'scan') {
    return 'Take control first (C).';
  }
  const endsRecording = command === 'record' && session.recording !== null;
  if (!endsRecording && !allowed[command].includes(session.state)) {
    return stateObstacle(command, session.state);
  }
  if (command !== 'power_off' && !endsRecording && bus?.connected !== true) {
    return 'No connection to the bus.';
  }
  if (starts.includes(command) && bus?.other_host === true) {
    return 'Another host drives modules on this bus: end it first.';
  }
  return null;
}
