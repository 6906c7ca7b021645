import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { DraftChanges } from '../../../../host/page/source/make/draft_changes.js';
import { PageState } from '../../../../host/page/source/state/page_state.js';
import { Random } from '../support/random.js';

interface Request {
  name: string;
  words: Record<string, unknown>;
  answer(): void;
  refuse(reason: string): void;
}

const tick = () => new Promise((resolve) => setImmediate(resolve));

// A program whose answers and documents come when the test says so.
class Program {
  readonly requests: Request[] = [];
  readonly state = new PageState();
  revision = 1;
  position = [0, 0, 0];
  shown = 0;
  readonly changes: DraftChanges;

  constructor() {
    this.connect(true);
    this.publish();
    const operations = { ask: (name: string, words: Record<string, unknown>) => this.ask(name, words) };
    this.changes = new DraftChanges({ operations, state: this.state } as never, () => (this.shown += 1));
  }

  private ask(name: string, words: Record<string, unknown>): Promise<unknown> {
    return new Promise((resolve, reject) => {
      const answer = () => {
        this.position = words['position'] as number[];
        this.revision += 1;
        resolve({ revision: this.revision });
      };
      this.requests.push({ name, words, answer, refuse: (reason) => reject(new Error(reason)) });
    });
  }

  publish(layout = 0, revision = this.revision): void {
    this.state.draft.value = { revision, layout, world: { start: { position: this.position, degrees: [0, 0, 0] } } } as never;
  }

  connect(isConnected: boolean): void {
    this.state.connection.value = isConnected
      ? { state: 'open', client: 1, program: 'proleg', nextNotice: 0 }
      : { state: 'lost', attempts: 1 };
  }

  setAxis(axis: number, value: number): Promise<string | null> {
    return this.changes.changeOf('world.start', ({ world }) => ({
      position: world.start.position.map((old, i) => (i === axis ? value : old)) as [number, number, number],
      degrees: world.start.degrees,
    }));
  }
}

const at = (x: number) => ({ position: [x, 0, 0] as [number, number, number], degrees: [0, 0, 0] as [number, number, number] });

describe('changes of the draft', () => {
  it('are done when the draft with them has come, not when they are answered', async () => {
    const program = new Program();
    let refusal: string | null | undefined;
    void program.changes.change('world.start', at(1)).then((reason) => (refusal = reason));
    program.requests[0]!.answer();
    await tick();
    assert.equal(refusal, undefined);
    program.publish();
    await tick();
    assert.equal(refusal, null);
  });

  it('are settled when the draft of the last step of a gesture has come: undo takes back the whole drag', async () => {
    const program = new Program();
    let isSettled = false;
    program.changes.follow('world.start', at(1), 7);
    program.changes.follow('world.start', at(2), 7);
    void program.changes.settled().then(() => (isSettled = true));
    program.requests[0]!.answer();
    program.publish();
    await tick();
    assert.deepEqual([program.requests.length, isSettled], [2, false]);
    program.requests[1]!.answer();
    await tick();
    assert.equal(isSettled, false);
    program.publish();
    await tick();
    assert.equal(isSettled, true);
    await program.changes.settled();
  });

  it('give the reason of a refusal at once, and tell it as a notice', async () => {
    const program = new Program();
    const done = program.changes.tell('world.start', at(1));
    program.requests[0]!.refuse('found 1, expected 2');
    assert.equal(await done, false);
    assert.deepEqual(program.state.notices.value.map(({ text }) => text), ['found 1, expected 2']);
  });

  it('of one number of several lose none, in whatever order answers and documents come', async () => {
    for (let seed = 1; seed <= 200; seed++) {
      const random = new Random(seed);
      const program = new Program();
      const expected = [0, 0, 0];
      const all: Promise<string | null>[] = [];
      let answered = 0;
      const step = async () => {
        if (random.next() < 0.5 && answered < program.requests.length) program.requests[answered++]!.answer();
        if (random.next() < 0.5) program.publish();
        await tick();
      };
      for (let i = 0; i < 12; i++) {
        const axis = random.integer(0, 2);
        expected[axis] = i + 1;
        all.push(program.setAxis(axis, i + 1));
        if (random.next() < 0.5) await step();
      }
      for (let i = 0; i < 400 && answered < 12; i++) await step();
      program.publish();
      assert.deepEqual(await Promise.all(all), Array(12).fill(null), `seed ${seed}`);
      assert.deepEqual(program.position, expected, `seed ${seed}`);
    }
  });

  it('of one number of several follow a gesture that has not come to its end', async () => {
    const program = new Program();
    program.changes.follow('world.start', at(5), 1);
    const done = program.setAxis(1, 7);
    await tick();
    assert.equal(program.requests.length, 1);
    program.requests[0]!.answer();
    await tick();
    assert.equal(program.requests.length, 1, 'the draft has not come');
    program.publish();
    await tick();
    assert.deepEqual(program.requests[1]?.words['position'], [5, 7, 0]);
    program.requests[1]!.answer();
    program.publish();
    assert.equal(await done, null);
  });

  it('of one number of several are refused if other parts have come or gone', async () => {
    const program = new Program();
    const first = program.changes.change('world.start', at(1));
    const second = program.setAxis(1, 7);
    program.requests[0]!.answer();
    program.publish(3);
    assert.equal(await first, null);
    assert.match((await second) ?? '', /parts/);
    assert.equal(program.requests.length, 1);
  });

  it('send the newest step of a gesture, and show the draft when the last one has come', async () => {
    const program = new Program();
    let ended = 0;
    for (let x = 1; x <= 9; x++) program.changes.follow('world.start', at(x), 1);
    program.changes.afterLastStep(() => (ended += 1));
    program.requests[0]!.answer();
    await tick();
    assert.deepEqual(program.requests.map(({ words }) => words['position']), [[1, 0, 0], [9, 0, 0]]);
    program.publish();
    await tick();
    assert.equal(ended, 0);
    program.requests[1]!.answer();
    await tick();
    assert.equal(ended + program.shown, 0, 'the draft has not come');
    program.publish();
    await tick();
    assert.deepEqual([ended, program.shown], [1, 1]);
    program.changes.afterLastStep(() => (ended += 1));
    assert.equal(ended, 2, 'nothing is on its way');
  });

  it('do not show the draft of an earlier step that comes after the answer to a later one', async () => {
    const program = new Program();
    program.changes.follow('world.start', at(1), 1);
    program.requests[0]!.answer();
    await tick();
    program.changes.follow('world.start', at(2), 1);
    program.requests[1]!.answer();
    await tick();
    program.publish(0, program.revision - 1);
    await tick();
    assert.equal(program.shown, 0);
    program.publish();
    await tick();
    assert.equal(program.shown, 1);
  });

  it('end every wait when the connection is lost, and count anew with another program', async () => {
    const program = new Program();
    const done = program.changes.change('world.start', at(1));
    program.requests[0]!.answer();
    await tick();
    program.connect(false);
    assert.equal(await done, null);
    program.revision = 0;
    program.publish();
    program.connect(true);
    const next = program.changes.change('world.start', at(2));
    program.requests[1]!.answer();
    program.publish();
    assert.equal(await next, null);
  });
});
