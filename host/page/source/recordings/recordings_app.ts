// The page Recordings: the files, and the one that is shown.
import { effect, signal } from '@preact/signals-core';
import { onFrame } from '../frame_clock.js';
import type { PageApp } from '../page_app.js';
import type { RecordedFile } from '../wire/messages.js';
import { OpenedRecording } from './opened_recording.js';
import { listRecordings, RecordingClient } from './recording_client.js';

const listPeriod = 2000; // milliseconds between two looks at the folder
const longestFrame = 250; // milliseconds: a tab that was hidden goes on where it was

export class RecordingsApp {
  readonly files = signal<readonly RecordedFile[] | null>(null);
  readonly opened = signal<OpenedRecording | null>(null);
  // The file that is being opened; why the list or a file cannot be shown.
  readonly opening = signal<string | null>(null);
  readonly problem = signal<string | null>(null);
  private listedAt = -Infinity;
  private isListing = false;
  private last = performance.now();

  constructor(readonly page: PageApp) {
    onFrame((now) => this.advance(now));
    effect(() => {
      const file = page.state.recordings.value?.open ?? null;
      if (file !== null && this.opened.peek() === null) void this.open(file);
    });
  }

  async open(file: string): Promise<void> {
    this.opening.value = file;
    this.problem.value = null;
    try {
      const client = new RecordingClient(this.page.operations, file);
      const opened = new OpenedRecording(client, await client.open(), () => this.page.startSceneWorker(), this.page.actions);
      opened.actions.add({
        id: 'close_recording',
        title: 'Back to the list',
        group: 'Recording',
        keys: ['Backspace'],
        run: () => this.close(),
      });
      if (this.opening.peek() === file) this.show(opened);
    } catch (error) {
      this.problem.value = (error as Error).message;
    }
    this.opening.value = null;
  }

  close(): void {
    this.show(null);
    this.listedAt = -Infinity;
  }

  private show(opened: OpenedRecording | null): void {
    this.opened.value = opened;
    this.page.recordingActions.value = opened?.actions ?? null;
  }

  private advance(now: number): void {
    const milliseconds = Math.min(longestFrame, Math.max(0, now - this.last));
    this.last = now;
    if (this.page.shownPage.peek() !== 'recordings' || !this.page.state.isConnected.peek()) {
      return;
    }
    if (this.opened.peek() !== null) {
      this.opened.peek()?.advance(milliseconds);
    } else if (!this.isListing && now - this.listedAt > listPeriod) {
      this.listedAt = now;
      void this.list();
    }
  }

  private async list(): Promise<void> {
    this.isListing = true;
    try {
      this.files.value = await listRecordings(this.page.operations);
      // Files that were not read yet will be soon.
      if (this.files.value.some((file) => !file.described)) this.listedAt -= listPeriod * 0.8;
    } catch (error) {
      this.problem.value = (error as Error).message;
    }
    this.isListing = false;
  }
}
