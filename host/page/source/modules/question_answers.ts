// The answers to the questions of a job: one for each question, and why the last one was not taken.
import { computed, effect, signal, type ReadonlySignal } from '@preact/signals-core';
import type { ModuleJob } from '../wire/messages.js';

export interface AnswerPort {
  readonly job: ReadonlySignal<ModuleJob | null>;
  // The reason why this viewer cannot answer; null: it can.
  answerObstacle(): string | null;
  // Sends the answer to the present question. Returns whether the program has it.
  sendAnswer(word: string): Promise<boolean>;
}

export class QuestionAnswers {
  readonly refused = signal<string | null>(null); // why the last answer was not taken; null: it was
  private readonly sent = signal(''); // the question that was answered last

  constructor(private readonly port: AnswerPort) {
    this.noteRefusals();
  }

  readonly obstacle = computed(() => {
    const question = questionKey(this.port.job.value);
    const isWaiting = question === '' || this.sent.value === question;
    return this.port.answerObstacle() ?? (isWaiting ? 'Wait: the program has the answer.' : null);
  });

  async answer(word: string): Promise<void> {
    if (word === '' || this.obstacle.peek() !== null) return;
    this.sent.value = questionKey(this.port.job.peek());
    this.refused.value = null;
    if (!(await this.port.sendAnswer(word))) this.sent.value = '';
  }

  // An event is there as long as the job: only one that is new is about the last answer.
  private noteRefusals(): void {
    let known: string | null = null;
    effect(() => {
      const job = this.port.job.value;
      const text = job === null ? null : `${job.number} ${JSON.stringify(job.latest.refused ?? null)}`;
      const refused = known !== null && text !== known ? job?.latest.refused : undefined;
      known = text;
      if (refused === undefined) return;
      this.refused.value = refused.text;
      this.sent.value = '';
    });
  }
}

function questionKey(job: ModuleJob | null): string {
  return job?.question == null ? '' : `${job.number}/${job.question.number}`;
}
