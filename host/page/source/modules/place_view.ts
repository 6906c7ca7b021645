// The robot whose places are given, for the 3D view: it stands, and a click on a joint is an answer.
import { computed, effect, signal, type ReadonlySignal } from '@preact/signals-core';
import type { TelemetryHistory } from '../data/telemetry_history.js';
import type { ActionList } from '../state/actions.js';
import type { PageState } from '../state/page_state.js';
import { SignalSelection } from '../state/signal_selection.js';
import { TimeView } from '../state/time_view.js';
import type { Choice, RobotView } from '../view/robot_view.js';
import { StillRows } from '../view/still_rows.js';
import type { RobotDocument, TelemetryDocument } from '../wire/messages.js';

export class PlaceView implements RobotView {
  readonly state = {
    robot: signal<RobotDocument | null>(null),
    telemetry: signal<TelemetryDocument | null>(null),
    bus: signal(null),
    busSession: signal(null),
  };
  readonly marks = null;
  readonly mover = null;
  readonly poses = null;
  readonly selection = new SignalSelection();
  readonly tickRate = 100;
  readonly newestTick = 0;
  readonly wholePath = signal(new Float64Array()); // the robot goes nowhere
  readonly time = new TimeView();
  readonly choice: Choice;
  private readonly rows = new StillRows();

  // `placed`: joints that have their module, which are lit.
  constructor(
    page: PageState,
    readonly actions: ActionList,
    readonly startSceneWorker: () => Worker,
    placed: ReadonlySignal<readonly number[]>,
    choose: (joint: number) => void,
  ) {
    this.choice = {
      joints: placed,
      objects: signal([]),
      choose: (joint) => {
        if (joint !== null) choose(joint);
      },
    };
    // A live robot changes its document rarely; its modules change all the time.
    const source = computed(() => page.modules.value?.robot?.document ?? null);
    effect(() => {
      const isDraft = source.value === 'draft_robot';
      const robot = source.value === null ? null : isDraft ? page.draftRobot.value : page.robot.value;
      if (robot === null) return;
      const meshes = isDraft ? [...page.draftMeshes.value] : robot.meshes;
      this.rows.place(null, robot.joints.length);
      this.state.robot.value = { ...robot, terrain: [], objects: [], rulers: [], ...(meshes === undefined ? {} : { meshes }) };
    });
  }

  get history(): TelemetryHistory {
    return this.rows.history;
  }

  get sampledRows(): TelemetryHistory {
    return this.rows.history;
  }

  get rowsAtCursor(): TelemetryHistory {
    return this.rows.history;
  }
}
