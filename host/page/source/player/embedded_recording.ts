// The recording in this page: elements that `proleg export --html` has written.
import { inflate, rowsOfColumns } from '../data/column_block.js';
import type { RecordedRows, RecordingDocuments, RecordingSource } from '../data/recording_source.js';
import { rowLayout } from '../wire/subscription.js';

interface EmbeddedDocuments extends RecordingDocuments {
  block_rows: number;
}

export class EmbeddedRecording implements RecordingSource {
  readonly documents: EmbeddedDocuments;
  private readonly blocks: Element[];
  private readonly width: number;

  // Throws an Error if the page has no recording.
  constructor(page: Document) {
    const documents = page.getElementById('documents')?.textContent;
    if (!documents) {
      throw new Error('page: found no recording, expected one of “proleg export --html”');
    }
    this.documents = JSON.parse(documents) as EmbeddedDocuments;
    this.blocks = [...page.querySelectorAll('script.ticks')];
    this.width = rowLayout(this.documents.telemetry.signals).width;
  }

  async *rows(from: number, to: number): AsyncIterable<RecordedRows> {
    const { block_rows, recording } = this.documents;
    const blockOf = (tick: number) => Math.floor((tick - recording.first_tick) / block_rows);
    for (let number = blockOf(from); number <= blockOf(to); number += 1) {
      const text = this.blocks[number]?.textContent;
      if (!text) {
        return;
      }
      const values = rowsOfColumns(await inflate(text), this.width);
      const first = recording.first_tick + number * block_rows;
      const begin = Math.max(0, from - first);
      const end = Math.min(values.length / this.width, to + 1 - first);
      yield {
        tick: first + begin,
        rows: end - begin,
        width: this.width,
        values: values.subarray(begin * this.width, end * this.width),
      };
    }
  }
}
