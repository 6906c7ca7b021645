// Reads a recording: its document, which may grow, and the rows for the panels.
import { signal } from '@preact/signals-core';
import { wholePathOf } from '../panels/scene_pose.js';
import type { TelemetryHistory } from '../data/telemetry_history.js';
import type { Playback } from '../state/playback.js';
import type { RobotDocument, ServedRecordingDocument, Signal, TelemetryDocument } from '../wire/messages.js';
import { CursorRows } from './cursor_rows.js';
import { RangeRows, type AskRows } from './range_rows.js';
import type { OpenDocuments, RecordingClient } from './recording_client.js';

const lookPeriod = 1000; // milliseconds between two looks at a file that grows

export class RecordingReader {
  readonly robot: RobotDocument;
  readonly telemetry: TelemetryDocument;
  readonly document;
  readonly wholePath = signal<Float64Array | null>(null);
  // The reason why a part cannot be shown.
  readonly failure = signal<string | null>(null);
  readonly ask: AskRows;
  private readonly range: RangeRows;
  private readonly cursor: CursorRows;
  private readonly path: RangeRows;
  private shownPath = -1;
  private lookedAt = 0;
  private isLooking = false;

  constructor(
    readonly client: RecordingClient,
    documents: OpenDocuments,
    private readonly now: () => number,
  ) {
    this.robot = documents.robot;
    this.telemetry = documents.telemetry;
    this.document = signal<ServedRecordingDocument>(documents.recording);
    this.ask = (signals, from, to) => client.rows(signals, from, to);
    const failed = (reason: string) => (this.failure.value = reason);
    this.range = new RangeRows(this.ask, now, failed);
    this.path = new RangeRows(this.ask, now, failed);
    this.cursor = new CursorRows(this.ask, failed);
  }

  // The histories below are those of RobotView.
  get history(): TelemetryHistory {
    return this.range.lines;
  }

  get sampledRows(): TelemetryHistory {
    return this.range.samples;
  }

  get rowsAtCursor(): TelemetryHistory {
    return this.cursor.history;
  }

  has(tick: number): boolean {
    return this.cursor.has(tick);
  }

  // To be called at each frame while the recording is shown. `names`: names of signals; those that the recording has are
  // read.
  advance(time: Playback, names: ReadonlySet<string>): void {
    const { first_tick, last_tick, finished, indexed, damage, has_path } = this.document.peek();
    const signals = this.telemetry.signals.filter(({ name }) => names.has(name));
    const tick = time.cursor.peek();
    if (tick >= first_tick && tick <= last_tick) {
      this.cursor.want(tick, signals, first_tick, last_tick, time.isPlaying.peek());
    }
    this.range.want(time.range(), signals, first_tick, last_tick);
    if (has_path) {
      this.showPath(first_tick, last_tick, signals);
    }
    const isIndexed = indexed > last_tick - first_tick || damage !== null;
    if ((!finished || !isIndexed) && !this.isLooking && this.now() - this.lookedAt > lookPeriod) {
      void this.look();
    }
  }

  private showPath(first: number, last: number, signals: readonly Signal[]): void {
    const { run } = this.path.samples;
    this.path.want({ from: first, to: last }, signals.filter((signal) => signal.name === 'head'), first, last);
    if (this.path.samples.end > 0 && run !== this.shownPath) {
      this.shownPath = run;
      this.wholePath.value = wholePathOf(this.path.samples, this.document.peek().marks);
    }
  }

  private async look(): Promise<void> {
    this.isLooking = true;
    try {
      this.document.value = (await this.client.open()).recording;
    } catch (error) {
      this.failure.value = (error as Error).message;
    }
    this.lookedAt = this.now();
    this.isLooking = false;
  }
}
