// Asks about something that a person edits: some time after the last change, one question at a time, and only the answer to the
// newest one counts.
import { computed, signal } from '@preact/signals-core';

export class NewestAnswer<Question, Answer> {
  // The last answer, and to what. An earlier one stays until the next comes.
  readonly last = signal<{ question: Question; answer: Answer } | null>(null);
  readonly failure = signal<string | null>(null); // why there is no answer to the newest question
  // Whether the newest question has no answer yet.
  readonly isWaiting = computed(() => this.wanted.value !== this.answered.value);
  private readonly wanted = signal(0); // counts questions
  private readonly answered = signal(0); // the newest one that was answered or has failed
  private question: Question | null = null;
  private isAsking = false;
  private settled: (() => void)[] = [];

  // ask: may reject. after: a timer.
  constructor(
    private readonly ask: (question: Question) => Promise<Answer>,
    private readonly after: (ms: number, action: () => void) => void,
    private readonly delay: number, // milliseconds
  ) {}

  want(question: Question): void {
    this.question = question;
    const number = this.wanted.peek() + 1;
    this.wanted.value = number;
    this.after(this.delay, () => {
      if (number === this.wanted.peek()) void this.send();
    });
  }

  // Asks at once what is still to be asked, and waits until the newest question has its answer, or none can come.
  settle(): Promise<void> {
    if (!this.isWaiting.peek()) return Promise.resolve();
    void this.send();
    return new Promise((resolve) => this.settled.push(resolve));
  }

  private async send(): Promise<void> {
    const { question } = this;
    const number = this.wanted.peek();
    if (this.isAsking || question === null || number === this.answered.peek()) return;
    this.isAsking = true;
    let answer: Answer | null = null;
    let failure: string | null = null;
    try {
      answer = await this.ask(question);
    } catch (error) {
      failure = (error as Error).message;
    }
    this.isAsking = false;
    if (number === this.wanted.peek()) {
      if (answer !== null) this.last.value = { question, answer };
      this.failure.value = failure;
      this.answered.value = number;
      for (const resolve of this.settled.splice(0)) resolve();
    } else {
      // Another question has come meanwhile, and perhaps its time, too.
      void this.send();
    }
  }
}
