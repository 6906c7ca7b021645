// Creates the stores of the player and connects them.
import { signal } from '@preact/signals-core';
import { historyFor, loadTicks, type RecordingDocuments, type RecordingSource } from '../data/recording_source.js';
import type { TelemetryHistory } from '../data/telemetry_history.js';
import { wholePathOf } from '../panels/scene_pose.js';
import type { RobotView } from '../view/robot_view.js';
import { ActionList } from '../state/actions.js';
import { Playback } from '../state/playback.js';
import { SignalSelection } from '../state/signal_selection.js';
import type { RecordingDocument, RobotDocument, TelemetryDocument } from '../wire/messages.js';

// A recording that is played, from any source of rows.
export interface PlayedRecording extends RobotView {
  readonly recording: RecordingDocument;
  readonly parameters: RecordingDocuments['parameters'];
  readonly time: Playback;
}

export class PlayerApp implements PlayedRecording {
  readonly state;
  readonly recording: RecordingDocument;
  readonly history: TelemetryHistory;
  readonly time: Playback;
  readonly marks = null;
  readonly mover = null;
  readonly poses = null;
  readonly selection = new SignalSelection();
  readonly actions = new ActionList();
  readonly wholePath = signal<Float64Array | null>(null);
  // The share of the recording that has been read, 0 to 1, and the reason why it cannot be read.
  readonly loaded = signal(0);
  readonly failure = signal<string | null>(null);

  constructor(
    private readonly source: RecordingSource,
    readonly startSceneWorker: () => Worker,
  ) {
    const { robot, telemetry, recording } = source.documents;
    this.state = {
      robot: signal<RobotDocument | null>(robot),
      telemetry: signal<TelemetryDocument | null>(telemetry),
      bus: signal(null),
      busSession: signal(null),
    };
    this.recording = recording;
    this.history = historyFor(recording.last_tick - recording.first_tick + 1);
    this.time = new Playback(recording.first_tick, recording.last_tick, this.tickRate);
  }

  get sampledRows(): TelemetryHistory {
    return this.history;
  }

  get rowsAtCursor(): TelemetryHistory {
    return this.history;
  }

  get parameters() {
    return this.source.documents.parameters;
  }

  get tickRate(): number {
    return 1e6 / (this.source.documents.telemetry.tick_us || 10000);
  }

  get newestTick(): number {
    return this.recording.last_tick;
  }

  async load(): Promise<void> {
    const { first_tick, last_tick } = this.recording;
    try {
      await loadTicks(this.source, this.history, first_tick, last_tick, (tick) => {
        this.loaded.value = (tick + 1 - first_tick) / (last_tick + 1 - first_tick);
      });
      if (this.recording.has_path) {
        this.wholePath.value = wholePathOf(this.history, this.recording.marks);
      }
    } catch (error) {
      this.failure.value = `The file is damaged or not complete. ${(error as Error).message}`;
    }
  }
}
