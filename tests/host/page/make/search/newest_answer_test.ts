import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { NewestAnswer } from '../../../../../host/page/source/make/search/newest_answer.js';
import { settle } from '../../support/search_program.js';
import { SteadyClock } from '../../support/steady_clock.js';

const delay = 250;

function program() {
  const clock = new SteadyClock();
  const asked: { question: number; answer(text: string): Promise<unknown>; refuse(reason: string): Promise<unknown> }[] = [];
  const ask = (question: number) =>
    new Promise<string>((resolve, reject) => {
      asked.push({ question, answer: (text) => (resolve(text), settle()), refuse: (reason) => (reject(new Error(reason)), settle()) });
    });
  const newest = new NewestAnswer<number, string>(ask, (ms, action) => clock.after(ms, action), delay);
  const pass = async (ms: number) => {
    clock.advance(ms);
    await settle();
  };
  const answered = () => newest.last.value?.answer;
  return { newest, asked, pass, answered };
}

describe('what is checked while it is edited', () => {
  it('is asked some time after the last change, once', async () => {
    const { newest, asked, pass } = program();
    for (let question = 1; question <= 5; question += 1) {
      newest.want(question);
      await pass(100);
    }
    assert.equal(asked.length, 0);
    await pass(150);
    assert.deepEqual(asked.map(({ question }) => question), [5]);
    assert.equal(newest.isWaiting.value, true);
    await asked[0]!.answer('good');
    assert.deepEqual(newest.last.value, { question: 5, answer: 'good' });
    assert.equal(newest.isWaiting.value, false);
  });

  it('never shows the answer to an earlier question, and has one question on its way', async () => {
    const { newest, asked, pass, answered } = program();
    newest.want(1);
    await pass(delay);
    newest.want(2);
    await pass(delay);
    assert.equal(asked.length, 1);
    await asked[0]!.answer('old');
    assert.equal(answered(), undefined);
    assert.deepEqual(asked.map(({ question }) => question), [1, 2]);
    await asked[1]!.answer('new');
    assert.equal(answered(), 'new');
  });

  it('keeps the last answer until the next comes', async () => {
    const { newest, asked, pass, answered } = program();
    newest.want(1);
    await pass(delay);
    await asked[0]!.answer('first');
    newest.want(2);
    await pass(delay);
    assert.equal(answered(), 'first');
    assert.equal(newest.isWaiting.value, true);
  });

  it('says why there is no answer, until there is one', async () => {
    const { newest, asked, pass } = program();
    newest.want(1);
    await pass(delay);
    await asked[0]!.refuse('no connection to the program');
    assert.equal(newest.failure.value, 'no connection to the program');
    assert.equal(newest.isWaiting.value, false);
    newest.want(2);
    await pass(delay);
    await asked[1]!.answer('good');
    assert.equal(newest.failure.value, null);
  });

  it('can be waited for: it is then asked at once', async () => {
    const { newest, asked } = program();
    await newest.settle();
    newest.want(1);
    let isSettled = false;
    void newest.settle().then(() => (isSettled = true));
    await settle();
    assert.equal(asked.length, 1);
    newest.want(2); // the newest counts, also for who has waited before
    await asked[0]!.answer('old');
    assert.equal(isSettled, false);
    await asked[1]!.answer('new');
    assert.equal(isSettled, true);
  });

  it('does not wait forever for a program that has gone', async () => {
    const { newest, asked, answered } = program();
    newest.want(1);
    const settled = newest.settle();
    await settle();
    await asked[0]!.refuse('the connection was lost before the answer');
    await settled;
    assert.equal(answered(), undefined);
  });
});
