// A recording, either in the page itself (player/embedded_recording.ts) or behind a server.
import type { RecordingDocument, Documents } from '../wire/messages.js';
import { rowLayout } from '../wire/subscription.js';
import type { TelemetryMessage } from '../wire/telemetry_message.js';
import { pyramidBlock } from './min_max_pyramid.js';
import { TelemetryHistory } from './telemetry_history.js';

export interface RecordingDocuments extends Pick<Documents, 'robot' | 'parameters' | 'telemetry'> {
  recording: RecordingDocument;
}

// Rows of ticks one after another, with all signals of the telemetry document in its order.
export type RecordedRows = Pick<TelemetryMessage, 'tick' | 'rows' | 'width' | 'values'>;

export interface RecordingSource {
  readonly documents: RecordingDocuments;
  // Reads the ticks from `from` up to, including, `to`, in pieces that ascend without a gap. Throws an Error that says what
  // is wrong with the recording.
  rows(from: number, to: number): AsyncIterable<RecordedRows>;
}

// Makes a history that has room for these ticks.
export function historyFor(ticks: number): TelemetryHistory {
  return new TelemetryHistory(Math.max(1, Math.ceil(ticks / pyramidBlock)) * pyramidBlock);
}

// Reads ticks into a history. `onTick`: called with the last tick of each piece. Throws an Error if ticks are missing.
export async function loadTicks(
  source: RecordingSource,
  history: TelemetryHistory,
  from: number,
  to: number,
  onTick: (tick: number) => void = () => {},
): Promise<void> {
  const layout = rowLayout(source.documents.telemetry.signals);
  let next = from;
  for await (const rows of source.rows(from, to)) {
    if (rows.tick !== next) {
      throw new Error(`recording: found tick ${rows.tick}, expected tick ${next}`);
    }
    history.append({ ...rows, subscription: 0, stride: 1, run: 0, hasGap: false }, layout);
    next += rows.rows;
    onTick(next - 1);
  }
  if (next !== to + 1) {
    throw new Error(`recording: found ticks up to ${next - 1}, expected ticks up to ${to}`);
  }
}
