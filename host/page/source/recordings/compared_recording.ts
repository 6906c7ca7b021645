// A second recording that is shown beside the first, and how their set-points, motion, parameters and results differ.
import { signal } from '@preact/signals-core';
import type { Playback } from '../state/playback.js';
import type { Documents, RunComparison, ServedRecordingDocument } from '../wire/messages.js';
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
    readonly parameters: Documents['parameters'],
    private readonly now: () => number,
  ) {
    this.comparison = signal(comparison);
    this.askedAt = now();
  }

  // Opens a second recording. Rejects with one line if the two cannot be compared.
  static async open(first: RecordingClient, second: RecordingClient, now: () => number = () => performance.now()): Promise<ComparedRecording> {
    const comparison = await first.compare(second);
    const documents = await second.open();
    return new ComparedRecording(first, new RecordingReader(second, documents, now), comparison, documents.parameters, now);
  }

  get name(): string {
    return this.reader.client.file;
  }

  get recording(): ServedRecordingDocument {
    return this.reader.document.value;
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
export function isDecided({ first_tick, last_tick, compared, difference, motion, damage }: RunComparison): boolean {
  return (difference !== null && motion?.difference !== null) || damage !== null || compared > last_tick - first_tick;
}

// One line that says which ticks both recordings have, and whether their set-points and their motion are the same.
export function comparisonText(comparison: RunComparison): string {
  const { first_tick, last_tick, compared, difference, motion } = comparison;
  const ticks = last_tick - first_tick + 1;
  const parts = [`ticks ${first_tick} to ${last_tick} are in both`];
  const moved = motion?.difference ?? null;
  if (motion === null) {
    parts.push('the motion was not compared, because a robot was not simulated');
  } else if (moved !== null) {
    parts.push(`the motion departs from tick ${moved.tick} on (${moved.part})`);
  }
  if (difference !== null) {
    parts.push(`the set-points differ from tick ${difference.tick} on (${difference.joint})`);
  }
  if (!isDecided(comparison)) {
    parts.push(`comparing … ${Math.floor((100 * compared) / ticks)} %`);
  } else if (compared >= ticks && (difference === null || (motion && moved === null))) {
    const same = [motion && moved === null ? 'the same motion' : '', difference === null ? 'the same set-points' : ''];
    parts.push(`${same.filter((text) => text !== '').join(' and ')} in all ${ticks} ticks, bit for bit`);
  }
  return parts.join('; ');
}

// The distances that the heads moved in the common ticks, as text.
export function wayText({ head_m }: RunComparison): string {
  const way = (metres: number | null) => (metres === null ? 'not known' : `${metres.toFixed(3)} m`);
  return `head: ${way(head_m[0])}, second ${way(head_m[1])}`;
}
