import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { pageSignal } from '../support/page_signal.js';
import { PlaceAnswers, placedModules } from '../../../../host/page/source/modules/place_answers.js';
import { QuestionAnswers } from '../../../../host/page/source/modules/question_answers.js';
import { ActionList } from '../../../../host/page/source/state/actions.js';
import { PageState } from '../../../../host/page/source/state/page_state.js';
import type { JobQuestion, ModuleJob, ModulesDocument } from '../../../../host/page/source/wire/messages.js';
import { jobOf } from './module_job.js';

const joints = [1, 2, 3].map((number) => ({ name: `J${number}`, node: number, serial: null }));
const document = { bus: 'can0', robot: { document: 'robot', name: 'caterpillar', joints } } as unknown as ModulesDocument;
const asked = (number: number): JobQuestion => ({ number, question: 'joint', node: 3, serial: 30 });

function places() {
  const job = pageSignal<ModuleJob | null>(jobOf({ kind: 'assign', question: asked(1) }));
  const words: string[] = [];
  let takes = true;
  const actions = new ActionList();
  const questions = new QuestionAnswers({
    job: job as never,
    answerObstacle: () => null,
    sendAnswer: (word) => {
      words.push(word);
      return Promise.resolve(takes);
    },
  });
  const answers = new PlaceAnswers({
    page: { state: new PageState(), startSceneWorker: () => assert.fail('no worker') },
    job: job as never,
    modules: pageSignal(document) as never,
    task: pageSignal('places') as never,
    actions,
    answers: questions,
  });
  const press = (key: string) => actions.forKey({ key, ctrlKey: false, metaKey: false, shiftKey: false, altKey: false }, false)?.run();
  return { job, words, answers, questions, press, refuse: () => (takes = false) };
}

describe('the answers to which joint moves', () => {
  it('are digits and Enter, wherever the focus is', () => {
    const { words, answers, press, job } = places();
    press('Enter');
    assert.deepEqual(words, []);
    press('1');
    press('2');
    assert.equal(answers.typed.value, '12');
    press('Enter');
    assert.deepEqual(words, ['12']);
    job.value = jobOf({ kind: 'assign' });
    press('1');
    assert.equal(answers.typed.value, '');
  });

  it('are given once for each question', () => {
    const { words, answers, job } = places();
    answers.answer('J2');
    answers.answer('J3');
    assert.deepEqual(words, ['J2']);
    assert.equal(answers.canPlace.value, false);
    job.value = jobOf({ kind: 'assign', question: asked(2) });
    assert.equal(answers.canPlace.value, true);
    answers.answer('J3');
    assert.deepEqual(words, ['J2', 'J3']);
  });

  it('can be given again if the connection or the program has refused one', async () => {
    const { words, questions, refuse } = places();
    refuse();
    await questions.answer('J2');
    await questions.answer('J2');
    assert.deepEqual(words, ['J2', 'J2']);
  });

  it('are shown with the reason why the program has not taken one, until the next answer', () => {
    const { questions, job } = places();
    void questions.answer('J9');
    job.value = jobOf({ kind: 'assign', question: asked(2), latest: { refused: { text: "found 'J9'" } } });
    assert.equal(questions.refused.value, "found 'J9'");
    void questions.answer('J2');
    assert.equal(questions.refused.value, null);
    job.value = jobOf({ kind: 'assign', question: asked(3), latest: { refused: { text: "found 'J9'" } } });
    assert.equal(questions.refused.value, null);
  });

  it('mark the joints that have their module, at the end those of the result', () => {
    const latest = { places: { modules: [{ serial: 10, node: 5, joint: 'J1' }, { serial: 11, node: 6, joint: null }] } };
    assert.deepEqual([...placedModules(jobOf({ kind: 'assign', latest })).keys()], ['J1']);
    const result = { joints: [{ joint: 'J2', node: 2, serial: 20 }, { joint: 'J3', node: null, serial: null }], changed: true, new_modules: 0 };
    assert.deepEqual([...placedModules(jobOf({ kind: 'assign', state: 'ended', latest, result }))], [['J2', { node: 2, serial: 20 }]]);
  });
});
