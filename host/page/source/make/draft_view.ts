// The robot of the draft for the panels that show a robot: it stands at its start, and its path is the foresight. Or it moves,
// and beside it a candidate of a search.
import { computed, effect, signal } from '@preact/signals-core';
import type { TelemetryHistory } from '../data/telemetry_history.js';
import { ActionList } from '../state/actions.js';
import type { PageState } from '../state/page_state.js';
import { SignalSelection } from '../state/signal_selection.js';
import { TimeView, type ShownTime } from '../state/time_view.js';
import type { Choice, RobotView } from '../view/robot_view.js';
import { StillRows } from '../view/still_rows.js';
import type { RobotDocument, TelemetryDocument } from '../wire/messages.js';
import type { MotionPair } from './search/motion.js';

export class DraftView implements RobotView {
  readonly state = {
    robot: signal<RobotDocument | null>(null),
    telemetry: signal<TelemetryDocument | null>(null),
    bus: signal(null),
    busSession: signal(null),
  };
  readonly wantedMotion = signal<MotionPair | null>(null); // null: it stands
  // A motion of a robot with other joints waits until it is replaced.
  readonly motion = computed(() => {
    const motion = this.wantedMotion.value;
    return motion !== null && motion.draft.joints === this.state.robot.value?.joints.length ? motion : null;
  });
  readonly compared = computed(() => this.motion.value?.compared ?? null);
  readonly marks = null;
  readonly mover = null;
  readonly poses = null;
  readonly selection = new SignalSelection();
  readonly tickRate = 100;
  readonly wholePath = computed<Float64Array | null>(() => this.motion.value?.wholePath ?? this.foresight.value);
  private readonly start = new StillRows();
  private readonly noTime = new TimeView();
  private readonly foresight = signal<Float64Array | null>(null);

  constructor(
    page: PageState,
    readonly actions: ActionList,
    readonly startSceneWorker: () => Worker,
    readonly choice: Choice,
  ) {
    effect(() => {
      const robot = page.draftRobot.value;
      const meshes = page.draftMeshes.value;
      const head = page.draft.value?.head;
      if (robot === null || head === undefined) return;
      this.start.place(head, robot.joints.length);
      this.state.robot.value = { ...robot, meshes: [...meshes] };
    });
    effect(() => {
      const path = page.foresight.value?.path ?? [];
      this.foresight.value = Float64Array.from(path.flatMap((point) => [...point, 1, 0, 0, 0]));
    });
  }

  get time(): ShownTime {
    return this.motion.peek()?.time ?? this.noTime;
  }

  get history(): TelemetryHistory {
    return this.motion.peek()?.draft.rows ?? this.start.history;
  }

  get sampledRows(): TelemetryHistory {
    return this.history;
  }

  get rowsAtCursor(): TelemetryHistory {
    return this.history;
  }

  get newestTick(): number {
    return this.motion.peek()?.time.last ?? 0;
  }
}
