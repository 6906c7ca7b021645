import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { RowReader } from '../../../../../host/page/source/make/search/row_reader.js';
import { RowStore } from '../../../../../host/page/source/make/search/row_store.js';
import type { SearchRows } from '../../../../../host/page/source/wire/messages.js';
import { rowsFrom, settle } from '../../support/search_program.js';

interface Question {
  from: number;
  answer(rows: SearchRows): Promise<unknown>;
  refuse(reason: string): Promise<unknown>;
}

function readerOf() {
  const asked: Question[] = [];
  const ask = (from: number) =>
    new Promise<SearchRows>((resolve, reject) => {
      asked.push({ from, answer: (rows) => (resolve(rows), settle()), refuse: (reason) => (reject(new Error(reason)), settle()) });
    });
  const store = new RowStore(1, 1);
  return { reader: new RowReader(store, ask), store, asked };
}

const thousand = (from: number, made: number) => rowsFrom(from, Array.from({ length: Math.min(1000, made - from) }, (_, i) => from + i), made);

describe('the evaluations of a search that is shown', () => {
  it('are read to the last one at once, in several answers, one question at a time', async () => {
    const { reader, store, asked } = readerOf();
    const made = 100_000;
    let frames = 0;
    for (; store.count < made; frames += 1) {
      reader.advance(frames, made, false); // a frame each millisecond
      reader.advance(frames, made, false);
      const question = asked.at(-1)!;
      assert.equal(question.from, store.count);
      await question.answer(thousand(question.from, made));
    }
    assert.equal(asked.length, 100);
    assert.ok(frames < 1000, 'no second passes between two answers');
  });

  it('are then asked for once a second while it runs, from the last known number on', async () => {
    const { reader, asked } = readerOf();
    reader.advance(0, 3, true);
    await asked[0]!.answer(rowsFrom(0, [1, 2, 3]));
    for (let now = 0; now < 1000; now += 16) reader.advance(now, 3, true);
    assert.equal(asked.length, 1);
    reader.advance(1000, 3, true);
    assert.equal(asked[1]!.from, 3);
    reader.advance(5000, 3, true);
    assert.equal(asked.length, 2, 'the last question has no answer yet');
    await asked[1]!.answer(rowsFrom(3, []));
    reader.advance(2000, 3, true);
    assert.equal(asked.length, 3);
  });

  it('of one that has ended are read to their end and not asked for again', async () => {
    const { reader, asked } = readerOf();
    reader.advance(0, 2, false);
    await asked[0]!.answer(rowsFrom(0, [1, 2]));
    for (let now = 0; now < 60_000; now += 500) reader.advance(now, 2, false);
    assert.equal(asked.length, 1);
    reader.advance(60_000, 4, false); // it was resumed elsewhere
    assert.equal(asked[1]!.from, 2);
  });

  it('of a repetition are read once: how many there are is not known before', async () => {
    const { reader, store, asked } = readerOf();
    reader.advance(0, 0, false);
    await asked[0]!.answer(thousand(0, 1500));
    reader.advance(1, 0, false);
    await asked[1]!.answer(thousand(1000, 1500));
    for (let now = 2; now < 10_000; now += 100) reader.advance(now, 0, false);
    assert.deepEqual([store.count, asked.length], [1500, 2]);
  });

  it('are asked for again a second after a refusal, whose reason is shown until then', async () => {
    const { reader, store, asked } = readerOf();
    reader.advance(0, 2, false);
    await asked[0]!.refuse('no connection to the program');
    assert.equal(reader.problem.value, 'no connection to the program');
    reader.advance(999, 2, false);
    assert.equal(asked.length, 1);
    reader.advance(1000, 2, false);
    await asked[1]!.answer(rowsFrom(0, [1, 2]));
    assert.equal(reader.problem.value, null);
    assert.equal(store.count, 2);
  });

  it('are read anew if another search has come into the folder', async () => {
    const { reader, store, asked } = readerOf();
    reader.advance(0, 3, true);
    await asked[0]!.answer(rowsFrom(0, [1, 2, 3]));
    reader.advance(1000, 3, true);
    await asked[1]!.answer({ from: 3, made: 1, scores: [], values: [], flags: [] });
    assert.deepEqual([store.count, store.clears], [0, 1]);
    reader.advance(2000, 1, true);
    await asked[2]!.answer(rowsFrom(0, [7]));
    assert.equal(store.scoreOf(0, 0), 7);
  });

  it('that come when it is no longer shown are dropped', async () => {
    const { reader, store, asked } = readerOf();
    reader.advance(0, 3, true);
    reader.close();
    await asked[0]!.answer(rowsFrom(0, [1, 2, 3]));
    reader.advance(5000, 3, true);
    assert.deepEqual([store.count, asked.length], [0, 1]);
  });
});
