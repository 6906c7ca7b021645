// The entry of a class: the form, the request, and what becomes of its answer.
import { signal } from '@preact/signals-core';
import { cleanCode, cleanName, problemOfAnswer, problemOfWish, readAnswer, type JoinAnswer, type JoinProblem, type JoinWish } from './join.js';
import type { KeyStore } from './key_store.js';

export interface EntryPorts {
  // POST /join. Rejects if there is no answer; with an AbortError after the time that an entry waits.
  post(wish: JoinWish): Promise<{ status: number; body: string }>;
  enter(answer: JoinAnswer): void; // goes to the robot
  makeKey(): string;
}

export class EntryState {
  readonly name = signal('');
  readonly code = signal('');
  readonly problem = signal<JoinProblem | null>(null);
  readonly isBusy = signal(false);
  readonly known = signal<readonly string[]>([]); // names whose keys this computer has

  // `codeOfLink`: null: the learner writes it. `pending`: keys that were sent and not answered yet: with the same key a learner
  // gets the seat whose answer was lost.
  constructor(
    readonly codeOfLink: string | null,
    private readonly keys: KeyStore,
    private readonly pending: KeyStore,
    private readonly ports: EntryPorts,
  ) {
    this.code.value = codeOfLink ?? '';
    this.readKnown();
  }

  async submit(): Promise<void> {
    const name = cleanName(this.name.value);
    const code = cleanCode(this.code.value);
    const key = this.keys.keyOf(name);
    this.problem.value = problemOfWish(name, code, key === null);
    if (this.problem.value === null) await this.join({ name, code, key: key ?? this.newKey(name) });
  }

  // A name that has joined at this computer before.
  async goOn(name: string): Promise<void> {
    this.name.value = name;
    await this.submit();
  }

  forget(name: string): void {
    this.keys.forget(name);
    this.readKnown();
  }

  private async join(wish: JoinWish): Promise<void> {
    if (this.isBusy.value) return;
    this.isBusy.value = true;
    try {
      const { status, body } = await this.ports.post(wish);
      const answer = status === 200 ? readAnswer(body) : null;
      if (answer === null) {
        this.problem.value = problemOfAnswer(status, body, wish);
        this.isBusy.value = false;
        return;
      }
      this.keys.keep(answer.name, answer.key);
      this.ports.enter(answer); // busy until the browser has left this page
    } catch (error) {
      const isLate = (error as Error).name === 'AbortError';
      this.problem.value = {
        field: 'button',
        text: isLate ? 'Your robot does not start. Try again, or ask your teacher.' : 'The class does not answer. Ask your teacher, then try again.',
      };
      this.isBusy.value = false;
    }
  }

  private newKey(name: string): string {
    const key = this.pending.keyOf(name) ?? this.ports.makeKey();
    this.pending.keep(name, key);
    return key;
  }

  private readKnown(): void {
    this.known.value = this.keys.all().map(({ name }) => name);
  }
}
