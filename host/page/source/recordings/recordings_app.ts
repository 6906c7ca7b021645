// The stores of the page Recordings: the files, and the recording that is shown.
import { effect, signal } from '@preact/signals-core';
import { addFront } from '../view/front.js';
import { onFrame } from '../view/frame_clock.js';
import type { Stores } from '../view/robot_view.js';
import type { RecordedFile } from '../wire/messages.js';
import { ComparedRecording } from './compared_recording.js';
import { OpenedRecording } from './opened_recording.js';
import { listRecordings, RecordingClient } from './recording_client.js';

const listPeriod = 2000; // milliseconds between two looks at the folder
const longestFrame = 250; // milliseconds: a tab that was hidden goes on where it was

export type RecordingsStores = Stores<'actions' | 'operations' | 'recordingActions' | 'shownPage' | 'startSceneWorker' | 'state'>;

export class RecordingsApp {
  readonly files = signal<readonly RecordedFile[] | null>(null);
  readonly opened = signal<OpenedRecording | null>(null);
  // The file that is being opened, and the reason why the list or a file cannot be shown.
  readonly opening = signal<string | null>(null);
  readonly problem = signal<string | null>(null);
  // The recording for which a second one is chosen from the list.
  readonly comparing = signal<string | null>(null);
  private listedAt = -Infinity;
  private isListing = false;
  private last = performance.now();

  constructor(readonly page: RecordingsStores) {
    onFrame((now) => this.advance(now));
    addFront({
      isOpen: () => page.shownPage.peek() === 'recordings' && this.comparing.peek() !== null,
      close: () => this.chooseSecond(null),
    });
    effect(() => {
      const file = page.state.recordings.value?.open ?? null;
      if (file !== null && this.opened.peek() === null) void this.open(file);
    });
  }

  async open(file: string): Promise<void> {
    await this.attempt(file, async () => {
      const client = new RecordingClient(this.page.operations, file);
      const opened = new OpenedRecording(client, await client.open(), () => this.page.startSceneWorker(), this.page.actions);
      opened.actions.add(
        {
          id: 'close_recording',
          title: 'Back to the list',
          group: 'Recording',
          keys: ['Backspace'],
          run: () => this.close(),
        },
        {
          id: 'compare',
          title: 'Compare with another recording, or end that',
          group: 'Recording',
          keys: ['D'],
          run: () => (opened.compared.peek() === null ? this.chooseSecond(file) : (opened.compared.value = null)),
        },
        {
          id: 'continue',
          title: 'Continue the simulation from the time cursor',
          group: 'Recording',
          keys: [],
          isEnabled: () => this.obstacleToContinue(opened) === null,
          obstacle: () => this.obstacleToContinue(opened),
          run: () => void this.continueFrom(opened),
        },
      );
      if (this.opening.peek() === file) this.show(opened);
    });
  }

  // Starts the choice of a second file from the list, which is compared with this one.
  chooseSecond(file: string | null): void {
    this.comparing.value = file;
    this.problem.value = null;
    this.listedAt = -Infinity;
  }

  // Shows the second recording beside the first.
  async compareWith(second: string): Promise<void> {
    const first = this.comparing.peek();
    if (first !== null && this.opened.peek()?.client.file !== first) {
      await this.open(first);
    }
    const opened = this.opened.peek();
    if (opened === null || this.problem.peek() !== null) return;
    await this.attempt(second, async () => {
      opened.compared.value = await ComparedRecording.open(opened.client, new RecordingClient(this.page.operations, second));
      this.comparing.value = null;
    });
  }

  // The reason why the simulation cannot continue from the time cursor; null: it can.
  obstacleToContinue({ recording }: OpenedRecording): string | null {
    const { robot, isConnected, isHolder } = this.page.state;
    if (recording.program !== 'simulate') return 'Only a simulation can be computed again, not a robot that had modules.';
    if (robot.value?.kind === 'bus') return 'This program drives a robot on a bus.';
    return !isConnected.value ? 'No connection to the program.' : isHolder.value ? null : 'Take control first (C).';
  }

  async continueFrom({ client, time }: OpenedRecording): Promise<void> {
    const answer = await this.page.operations.tell('continue', { file: client.file, tick: time.cursor.peek() });
    if (answer !== null) this.page.shownPage.value = 'live';
  }

  close(): void {
    this.show(null);
    this.listedAt = -Infinity;
  }

  // Opens a file; if that fails, the line of the error becomes `problem`.
  private async attempt(file: string, action: () => Promise<void>): Promise<void> {
    this.opening.value = file;
    this.problem.value = null;
    try {
      await action();
    } catch (error) {
      this.problem.value = (error as Error).message;
    }
    this.opening.value = null;
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
    if (this.opened.peek() !== null && this.comparing.peek() === null) {
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
      // The list is read again soon if it has files that were not read yet.
      if (this.files.value.some((file) => !file.described)) this.listedAt -= listPeriod * 0.8;
    } catch (error) {
      this.problem.value = (error as Error).message;
    }
    this.isListing = false;
  }
}
