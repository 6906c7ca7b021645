// A second recording that is shown beside the first, and how their set-points differ.
import { signal } from '@preact/signals-core';
import type { Playback } from '../state/playback.js';
import type { RunComparison } from '../wire/messages.js';
import type { RecordingClient } from './recording_client.js';
import { RecordingReader } from './recording_reader.js';

const askPeriod = 500; // milliseconds between two requests for the progress of the comparison

export class ComparedRecording {
  readonly comparison;
  private askedAt: number;
  private isAsking = false;

  private constructor(
    private readonly first: RecordingClient,
    readonly reader: RecordingReader,
    comparison: RunComparison,
    private readonly now: () => number,
  ) {
    this.comparison = signal(comparison);
    this.askedAt = now();
  }

  // Opens a second recording. Rejects with one line if the two cannot be compared.
  static async open(first: RecordingClient, second: RecordingClient, now: () => number = () => performance.now()): Promise<ComparedRecording> {
    const comparison = await first.compare(second);
    const documents = await second.open();
    return new ComparedRecording(first, new RecordingReader(second, documents, now), comparison, now);
  }

  get name(): string {
    return this.reader.client.file;
  }

  get failure(): string | null {
    return this.reader.failure.value ?? this.comparison.value.damage ?? this.reader.document.value.damage;
  }

  // To be called at each frame while the recording is shown. `names`: names of signals.
  advance(time: Playback, names: ReadonlySet<string>): void {
    this.reader.advance(time, names);
    const isKnown = isDecided(this.comparison.peek()) && this.reader.document.peek().finished;
    if (!isKnown && !this.isAsking && this.now() - this.askedAt > askPeriod) {
      void this.askAgain();
    }
  }

  private async askAgain(): Promise<void> {
    this.isAsking = true;
    try {
      this.comparison.value = await this.first.compare(this.reader.client);
    } catch (error) {
      this.reader.failure.value = (error as Error).message;
    }
    this.askedAt = this.now();
    this.isAsking = false;
  }
}

// Whether no further tick has to be compared.
export function isDecided({ first_tick, last_tick, compared, difference, damage }: RunComparison): boolean {
  return difference !== null || damage !== null || compared > last_tick - first_tick;
}

// One line that says which ticks both recordings have, and whether their set-points are the same.
export function comparisonText(comparison: RunComparison): string {
  const { first_tick, last_tick, compared, difference } = comparison;
  const ticks = last_tick - first_tick + 1;
  const both = `ticks ${first_tick} to ${last_tick} are in both`;
  if (difference !== null) {
    return `${both}; the set-points differ from tick ${difference.tick} on (${difference.joint})`;
  }
  return compared < ticks
    ? `${both}; comparing … ${Math.floor((100 * compared) / ticks)} %`
    : `${both}; the same set-points in all ${ticks} ticks, bit for bit`;
}

// The distances that the heads moved in the common ticks, as text.
export function wayText({ head_m }: RunComparison): string {
  const way = (metres: number | null) => (metres === null ? 'not known' : `${metres.toFixed(3)} m`);
  return `head: ${way(head_m[0])}, second ${way(head_m[1])}`;
}
