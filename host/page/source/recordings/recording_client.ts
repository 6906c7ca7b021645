// Reads a recording behind the server.
import type { OperationQueue } from '../state/operations.js';
import type { Documents, RecordedFile, RunComparison, ServedRecordingDocument, Signal } from '../wire/messages.js';
import { decodeRecordedRows, type RecordedRows } from '../wire/recorded_rows.js';
import { rowLayout } from '../wire/subscription.js';

export interface OpenDocuments extends Pick<Documents, 'robot' | 'parameters' | 'telemetry'> {
  recording: ServedRecordingDocument;
}

// The most rows of an answer, and the strides that it may have (docs/page-interface.md).
export const mostPoints = 2048;
const strides = [1, 8, 64, 512, 4096] as const;

// The stride of an answer for this number of ticks.
export function strideFor(ticks: number): number {
  return strides.find((stride) => Math.ceil(ticks / stride) <= mostPoints) ?? 4096;
}

export class RecordingClient {
  constructor(
    private readonly operations: Pick<OperationQueue, 'ask'>,
    readonly file: string,
  ) {}

  async open(): Promise<OpenDocuments> {
    return (await this.operations.ask('recording.open', { file: this.file })) as OpenDocuments;
  }

  // The progress of the comparison with another recording. Rejects if the two cannot be compared.
  async compare(other: RecordingClient): Promise<RunComparison> {
    return (await this.operations.ask('recording.compare', { file: this.file, with: other.file })) as RunComparison;
  }

  // Reads the ticks from `from` up to, including, `to`: every tick, or blocks if they are more than mostPoints. The answer
  // may end before `to`.
  async rows(signals: readonly Signal[], from: number, to: number): Promise<RecordedRows> {
    const names = signals.map((signal) => signal.name);
    const buffer = await this.operations.ask('recording.rows', { file: this.file, signals: names, from, to, points: mostPoints });
    return decodeRecordedRows(buffer as ArrayBuffer, rowLayout(signals).width);
  }
}

export async function listRecordings(operations: Pick<OperationQueue, 'ask'>): Promise<RecordedFile[]> {
  const { files } = (await operations.ask('recording.list', {})) as { files: RecordedFile[] };
  return files;
}
