// A recording that is shown, alone or with a second one: the values for the panels, and its time. A recording that grows is
// followed.
import { effect, signal, untracked } from '@preact/signals-core';
import { addPlaybackActions } from '../player/player_actions.js';
import type { PlayedRecording } from '../player/player_app.js';
import { ActionList, type Action } from '../state/actions.js';
import { Playback } from '../state/playback.js';
import { SignalSelection } from '../state/signal_selection.js';
import type { Documents, RobotDocument, ServedRecordingDocument, TelemetryDocument } from '../wire/messages.js';
import type { ComparedRecording } from './compared_recording.js';
import type { AskRows } from './range_rows.js';
import type { OpenDocuments, RecordingClient } from './recording_client.js';
import { RecordingReader } from './recording_reader.js';

export class OpenedRecording implements PlayedRecording {
  readonly state;
  readonly time: Playback;
  readonly marks = null;
  readonly mover = null;
  readonly poses = null;
  readonly selection = new SignalSelection();
  readonly compared = signal<ComparedRecording | null>(null);
  readonly parameters: Documents['parameters'];
  readonly actions: ActionList;
  private readonly reader: RecordingReader;

  constructor(
    client: RecordingClient,
    documents: OpenDocuments,
    readonly startSceneWorker: () => Worker,
    // Actions of the page that are available here, too.
    pageActions: ActionList,
    now: () => number = () => performance.now(),
  ) {
    const { robot, telemetry, recording, parameters } = documents;
    this.reader = new RecordingReader(client, documents, now);
    this.state = {
      robot: signal<RobotDocument | null>(robot),
      telemetry: signal<TelemetryDocument | null>(telemetry),
      bus: signal(null),
      busSession: signal(null),
    };
    this.parameters = parameters;
    this.time = new Playback(recording.first_tick, recording.last_tick, this.tickRate);
    if (!recording.finished) {
      this.time.seek(recording.last_tick);
    }
    const ofRobot = new Set(['stop', 'escape', 'take_control']);
    const isOfPage = (action: Action) => action.group === 'Page' || ofRobot.has(action.id);
    this.actions = new ActionList(pageActions, isOfPage);
    addPlaybackActions(this, ['K']);
    // The rows are read at once, because the next frame may come 30 ms later.
    effect(() => {
      this.time.cursor.value;
      this.read();
    });
  }

  get client(): RecordingClient {
    return this.reader.client;
  }

  get failure() {
    return this.reader.failure;
  }

  get ask(): AskRows {
    return this.reader.ask;
  }

  get recording(): ServedRecordingDocument {
    return this.reader.document.value;
  }

  get wholePath() {
    return this.reader.wholePath;
  }

  get history() {
    return this.reader.history;
  }

  get sampledRows() {
    return this.reader.sampledRows;
  }

  get rowsAtCursor() {
    return this.reader.rowsAtCursor;
  }

  get tickRate(): number {
    return 1e6 / (this.reader.telemetry.tick_us || 10000);
  }

  get newestTick(): number {
    return this.reader.document.peek().last_tick;
  }

  // To be called at each frame while the recording is shown.
  advance(milliseconds: number): void {
    const { time } = this;
    time.advance(milliseconds);
    if (this.newestTick > time.last) {
      time.extend(this.newestTick, time.cursor.peek() >= time.last);
    }
    this.read();
  }

  // Reads missing rows at the time cursor.
  private read(): void {
    untracked(() => {
      const names = new Set(this.selection.needed(this.reader.telemetry.signals).map((signal) => signal.name));
      this.reader.advance(this.time, names);
      this.compared.peek()?.advance(this.time, names);
    });
  }
}
