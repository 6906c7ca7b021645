// Changes of the draft that the page requests, and what it waits for: an answer may come before the documents.
import { effect } from '@preact/signals-core';
import type { Stores } from '../view/robot_view.js';
import type { DraftDocument, Operations, PartOperation } from '../wire/messages.js';

// Operations that name parts of the draft by their positions.
type PartOperationName = Extract<keyof Operations, `world.${string}` | `robot.${string}` | `behaviour.${string}`>;
type Arguments<Name extends PartOperationName> = Omit<Operations[Name], keyof PartOperation>;

// The reason if what was requested is refused, else null.
export function refusalOf(request: Promise<unknown>): Promise<string | null> {
  return request.then(
    () => null,
    (error: Error) => error.message,
  );
}

export class DraftChanges {
  private answered = 0; // the newest revision of the draft that an answer named
  private underWay: Promise<unknown> = Promise.resolve(); // the newest change that is no step of a gesture
  private isSending = false;
  private isBehind = false; // a step of a gesture is on its way, or its draft
  private waiting: (() => Promise<unknown>) | null = null; // the newest step that has not been sent
  private afterLast: (() => void)[] = []; // what is done when the draft of the last step has come

  // whenShown: the page has the draft of the last step of a gesture, and shows it instead of what the pointer wanted.
  constructor(
    private readonly page: Stores<'operations' | 'state'>,
    private readonly whenShown: () => void,
  ) {
    // Another program counts its revisions anew.
    effect(() => {
      if (!page.state.isConnected.value) this.answered = 0;
    });
  }

  // Requests a change, and waits until its draft has come. Returns the reason if it was refused, else null.
  change<Name extends PartOperationName>(name: Name, words: Arguments<Name>): Promise<string | null> {
    return this.follows(this.requestAndWait(name, words, this.layout));
  }

  // As change(), with words made of the draft that has all earlier changes: for one of several numbers that an operation sets
  // together. The layout is that of the present draft, for which the caller knows the positions of the parts.
  changeOf<Name extends PartOperationName>(name: Name, wordsOf: (draft: DraftDocument) => Arguments<Name>): Promise<string | null> {
    const { layout } = this;
    return this.follows(
      this.settled().then(() => {
        const draft = this.page.state.draft.peek();
        if (draft?.layout !== layout) return 'Other parts have come or gone meanwhile.';
        return this.requestAndWait(name, wordsOf(draft), layout);
      }),
    );
  }

  // As change(), with a notice if it was refused. Returns whether it was done.
  async tell<Name extends PartOperationName>(name: Name, words: Arguments<Name>): Promise<boolean> {
    return this.note(await this.change(name, words));
  }

  // Requests a step of a gesture, a slider or a pointer: of several that wait the newest is sent.
  follow<Name extends PartOperationName>(name: Name, words: Arguments<Name>, gesture: number): void {
    this.send(async () => this.note(await this.noted(this.request(name, words, this.layout, gesture))));
  }

  // One step is on its way; of those that come meanwhile the newest goes next.
  send(step: () => Promise<unknown>): void {
    if (this.isSending) {
      this.waiting = step;
      return;
    }
    this.isSending = true;
    this.isBehind = true;
    void step().finally(() => {
      this.isSending = false;
      const next = this.waiting;
      this.waiting = null;
      if (next !== null) this.send(next);
      else void this.whenDraftHasCome().then(() => this.show());
    });
  }

  // Waits until all that was requested is in the draft: undo, Save and Simulate are about what the person has just done.
  async settled(): Promise<void> {
    await Promise.all([this.underWay, new Promise<void>((resolve) => this.afterLastStep(resolve))]);
  }

  // Calls back when the draft of the last step has come: at once if there is none.
  afterLastStep(done: () => void): void {
    if (this.isBehind) this.afterLast.push(done);
    else done();
  }

  // Waits for the answer to a request that changes the draft, and for this draft. Returns the reason if it was refused, else null.
  async outcomeOf(request: Promise<unknown>): Promise<string | null> {
    const refusal = await this.noted(request);
    if (refusal === null) await this.whenDraftHasCome();
    return refusal;
  }

  private noted(request: Promise<unknown>): Promise<string | null> {
    return refusalOf(request.then((answer) => this.noteAnswer(answer)));
  }

  private noteAnswer(answer: unknown): void {
    this.answered = Math.max(this.answered, (answer as { revision?: number } | null)?.revision ?? 0);
  }

  // Waits for the draft of the newest answer, or a later one. Without a connection there is nothing to wait for.
  private whenDraftHasCome(): Promise<void> {
    const revision = this.answered;
    return new Promise((resolve) => {
      const stop = effect(() => {
        if (!this.hasCome(revision)) return;
        resolve();
        queueMicrotask(() => stop());
      });
    });
  }

  private hasCome(revision: number): boolean {
    const { draft, isConnected } = this.page.state;
    return (draft.value?.revision ?? 0) >= revision || !isConnected.value;
  }

  private get layout(): number {
    return this.page.state.draft.peek()?.layout ?? 0;
  }

  private follows(change: Promise<string | null>): Promise<string | null> {
    this.underWay = change;
    return change;
  }

  private request<Name extends PartOperationName>(name: Name, words: Arguments<Name>, layout: number, gesture?: number): Promise<unknown> {
    const all = { ...words, layout, ...(gesture === undefined ? {} : { gesture }) } as unknown as Operations[Name];
    return this.page.operations.ask(name, all);
  }

  private requestAndWait<Name extends PartOperationName>(name: Name, words: Arguments<Name>, layout: number): Promise<string | null> {
    return this.outcomeOf(this.request(name, words, layout));
  }

  private note(refusal: string | null): boolean {
    if (refusal !== null) this.page.state.addNotice('warning', refusal);
    return refusal === null;
  }

  private show(): void {
    if (this.isSending || !this.hasCome(this.answered)) return; // another step
    this.isBehind = false;
    this.whenShown();
    for (const done of this.afterLast.splice(0)) done();
  }
}
