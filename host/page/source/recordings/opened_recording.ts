// A recording that is shown: its documents, its rows, its time. A growing one is followed.
import { signal } from '@preact/signals-core';
import { wholePathOf } from '../panels/scene_pose.js';
import { addPlaybackActions } from '../player/player_actions.js';
import type { PlayedRecording } from '../player/player_app.js';
import { ActionList, type Action } from '../state/actions.js';
import { Playback } from '../state/playback.js';
import { SignalSelection } from '../state/signal_selection.js';
import type { Documents, RobotDocument, ServedRecordingDocument, Signal, TelemetryDocument } from '../wire/messages.js';
import { CursorRows } from './cursor_rows.js';
import { RangeRows, type AskRows } from './range_rows.js';
import type { OpenDocuments, RecordingClient } from './recording_client.js';

const lookPeriod = 1000; // milliseconds between two looks at a file that grows

export class OpenedRecording implements PlayedRecording {
  readonly state;
  readonly time: Playback;
  readonly marks = null;
  readonly mover = null;
  readonly poses = null;
  readonly selection = new SignalSelection();
  readonly wholePath = signal<Float64Array | null>(null);
  // Why something cannot be shown.
  readonly failure = signal<string | null>(null);
  readonly actions: ActionList;
  readonly ask: AskRows;
  private readonly document;
  private readonly parameterDocument: Documents['parameters'];
  private readonly range: RangeRows;
  private readonly cursor: CursorRows;
  private readonly path: RangeRows;
  private lookedAt = 0;
  private isLooking = false;

  constructor(
    readonly client: RecordingClient,
    documents: OpenDocuments,
    readonly startSceneWorker: () => Worker,
    // Actions of the page that hold here, too.
    pageActions: ActionList,
    private readonly now: () => number = () => performance.now(),
  ) {
    const { robot, telemetry, recording, parameters } = documents;
    this.state = {
      robot: signal<RobotDocument | null>(robot),
      telemetry: signal<TelemetryDocument | null>(telemetry),
      bus: signal(null),
      busSession: signal(null),
    };
    this.document = signal<ServedRecordingDocument>(recording);
    this.parameterDocument = parameters;
    this.time = new Playback(recording.first_tick, recording.last_tick, this.tickRate);
    if (!recording.finished) {
      this.time.seek(recording.last_tick);
    }
    this.ask = (signals, from, to) => client.rows(signals, from, to);
    const failed = (reason: string) => (this.failure.value = reason);
    this.range = new RangeRows(this.ask, this.now, failed);
    this.path = new RangeRows(this.ask, this.now, failed);
    this.cursor = new CursorRows(this.ask, failed);
    const isOfPage = (action: Action) => action.group === 'Page' || action.id === 'stop' || action.id === 'take_control';
    this.actions = new ActionList(pageActions, isOfPage);
    addPlaybackActions(this, ['K']);
  }

  get recording(): ServedRecordingDocument {
    return this.document.value;
  }

  get parameters(): Documents['parameters'] {
    return this.parameterDocument;
  }

  get history() {
    return this.range.lines;
  }

  get sampledRows() {
    return this.range.samples;
  }

  get rowsAtCursor() {
    return this.cursor.history;
  }

  get tickRate(): number {
    return 1e6 / (this.state.telemetry.peek()?.tick_us || 10000);
  }

  get newestTick(): number {
    return this.document.peek().last_tick;
  }

  // The signals that the panels show.
  neededSignals(): Signal[] {
    return this.selection.needed(this.state.telemetry.peek()?.signals ?? []);
  }

  // At each frame while it is shown.
  advance(milliseconds: number): void {
    const { time } = this;
    const { first_tick, last_tick, finished, indexed, damage, has_path } = this.document.peek();
    time.advance(milliseconds);
    const signals = this.neededSignals();
    this.cursor.want(time.cursor.peek(), signals, first_tick, last_tick, time.isPlaying.peek());
    this.range.want(time.range(), signals, first_tick, last_tick);
    if (has_path) {
      this.showPath(first_tick, last_tick);
    }
    const isIndexed = indexed > last_tick - first_tick || damage !== null;
    if ((!finished || !isIndexed) && !this.isLooking && this.now() - this.lookedAt > lookPeriod) {
      void this.look();
    }
  }

  private showPath(first: number, last: number): void {
    const { run } = this.path.samples;
    this.path.want({ from: first, to: last }, this.neededSignals().filter((signal) => signal.name === 'head'), first, last);
    if (this.path.samples.end > 0 && run !== this.shownPath) {
      this.shownPath = run;
      this.wholePath.value = wholePathOf(this.path.samples);
    }
  }
  private shownPath = -1;

  private async look(): Promise<void> {
    this.isLooking = true;
    try {
      const { recording } = await this.client.open();
      const isAtEnd = this.time.cursor.peek() >= this.newestTick;
      const follows = !this.document.peek().finished && isAtEnd;
      this.document.value = recording;
      this.time.extend(recording.last_tick, follows);
    } catch (error) {
      this.failure.value = (error as Error).message;
    }
    this.lookedAt = this.now();
    this.isLooking = false;
  }
}
