// What the panels that only show a robot need: of a live robot (page_app.ts), or of a recording (player/player_app.ts).
import type { ReadonlySignal } from '@preact/signals-core';
import type { TelemetryHistory } from './data/telemetry_history.js';
import type { ActionList } from './state/actions.js';
import type { MoveTool } from './state/move_tool.js';
import type { PageState } from './state/page_state.js';
import type { PoseQueue } from './state/pose_queue.js';
import type { SignalSelection } from './state/signal_selection.js';
import type { TimeMarks } from './state/time_marks.js';
import type { ShownTime } from './state/time_view.js';
import type { RobotDocument } from './wire/messages.js';

// A second recording that is shown beside the first.
export interface ComparedView {
  readonly reader: {
    readonly robot: RobotDocument;
    readonly history: TelemetryHistory;
    readonly rowsAtCursor: TelemetryHistory;
    readonly wholePath: ReadonlySignal<Float64Array | null>;
    has(tick: number): boolean;
  };
}

export interface RobotView {
  readonly state: Pick<PageState, 'robot' | 'telemetry' | 'bus' | 'busSession'>;
  readonly history: TelemetryHistory; // for lines: of a long time, the smallest and largest values
  readonly sampledRows: TelemetryHistory; // the same time, each row with the values of one tick
  readonly rowsAtCursor: TelemetryHistory; // every tick about the time cursor
  readonly time: ShownTime;
  readonly selection: SignalSelection;
  readonly actions: ActionList;
  readonly marks: TimeMarks | null; // of the user, in plots and strips; null: none can be set
  readonly mover: MoveTool | null; // puts the robot to another place; null: nothing does
  readonly poses: PoseQueue | null; // turns the joints of a robot on a bus; null: nothing does
  readonly tickRate: number; // ticks in a second
  readonly newestTick: number;
  // Where the head was in each row, as in `head` of the telemetry but in metres; not numbers where the path is cut. Null: the
  // path grows with the robot.
  readonly wholePath: ReadonlySignal<Float64Array | null>;
  readonly compared?: ReadonlySignal<ComparedView | null>;
  // The worker of the 3D view. Throws an Error if the browser starts none.
  startSceneWorker(): Worker;
}
