// The stores that panels read. RobotView: for panels that only show a robot, which may be live (page_app.ts) or recorded
// (player/player_app.ts). PageStores: for panels that also drive a robot (page_app.ts).
import type { ReadonlySignal, Signal } from '@preact/signals-core';
import type { TelemetryHistory } from '../data/telemetry_history.js';
import type { PlacedObject } from '../scene/scene_messages.js';
import type { ActionList } from '../state/actions.js';
import type { MoveTool } from '../state/move_tool.js';
import type { OperationQueue } from '../state/operations.js';
import type { PageState } from '../state/page_state.js';
import type { PoseQueue } from '../state/pose_queue.js';
import type { SetQueue } from '../state/set_queue.js';
import type { SignalSelection } from '../state/signal_selection.js';
import type { StopControl } from '../state/stop_report.js';
import type { TimeMarks } from '../state/time_marks.js';
import type { ShownTime, TimeView } from '../state/time_view.js';
import type { RobotDocument } from '../wire/messages.js';

// A second robot that is shown beside the first: a second recording, unless it says what it is.
export interface ComparedView {
  readonly legend?: string;
  readonly reader: {
    readonly robot: RobotDocument;
    readonly history: TelemetryHistory;
    readonly rowsAtCursor: TelemetryHistory;
    readonly wholePath: ReadonlySignal<Float64Array | null>;
    has(tick: number): boolean;
  };
}

// The parts of a scenario that a person has chosen, to change them.
export interface Choice {
  readonly joints: ReadonlySignal<readonly number[]>;
  readonly objects: ReadonlySignal<readonly PlacedObject[]>;
  // Chooses what was clicked in the 3D view; both null: there is nothing. adds: the others stay chosen.
  choose(joint: number | null, object: PlacedObject | null, adds: boolean): void;
}

export interface RobotView {
  readonly state: Pick<PageState, 'robot' | 'telemetry' | 'bus' | 'busSession'>;
  readonly history: TelemetryHistory; // rows for lines; for a long time, they have the smallest and largest values
  readonly sampledRows: TelemetryHistory; // rows of the time of `history`, each with the values of one tick
  readonly rowsAtCursor: TelemetryHistory; // rows of every tick near the time cursor
  readonly time: ShownTime;
  readonly selection: SignalSelection;
  readonly actions: ActionList;
  readonly marks: TimeMarks | null; // marks of the user in plots and strips; null: none can be set
  readonly mover: MoveTool | null; // moves the robot to another place; null: the robot cannot be moved
  readonly poses: PoseQueue | null; // turns the joints of a robot on a bus; null: they cannot be turned
  readonly tickRate: number; // ticks in a second
  readonly newestTick: number;
  // The place of the head in each row, like `head` of the telemetry but in metres; not numbers where the path is cut. Null:
  // the path grows with the robot.
  readonly wholePath: ReadonlySignal<Float64Array | null>;
  readonly choice?: Choice; // absent: nothing can be chosen
  readonly compared?: ReadonlySignal<ComparedView | null>;
  // The worker of the 3D view. Throws an Error if the browser starts none.
  startSceneWorker(): Worker;
}

export type PageName = 'live' | 'recordings' | 'make' | 'modules';

export interface PageStores extends RobotView {
  readonly state: PageState;
  readonly time: TimeView;
  readonly marks: TimeMarks;
  readonly mover: MoveTool;
  readonly poses: PoseQueue;
  readonly operations: OperationQueue;
  readonly sets: SetQueue;
  readonly stop: StopControl;
  readonly shownPage: Signal<PageName>;
  readonly recordingActions: Signal<ActionList | null>; // of the recording on the page Recordings
  readonly makeActions: Signal<ActionList | null>; // of the page Make
  readonly modulesActions: Signal<ActionList | null>; // of the page Modules
  readonly wantedScenario: Signal<string | null>; // which the page Make is to open
  readonly shownActions: ActionList; // of the page that is shown, for keys and the palette
  // A number for changes that undo takes back together.
  newGesture(): number;
}

// The stores that one panel reads.
export type Stores<Name extends keyof PageStores> = Pick<PageStores, Name>;
