import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { SearchApp } from '../../../../../host/page/source/make/search/search_app.js';
import { motionBytes } from '../../support/motion_bytes.js';
import { entry, openedSearch, rowsFrom, SearchProgram, settle } from '../../support/search_program.js';

const words = ['amplitude:J5=35', 'amplitude:J1=12.5'];

function appOf() {
  const program = new SearchProgram();
  const app = new SearchApp(program.host, program.after);
  return { program, app };
}

async function withCandidate() {
  const { program, app } = appOf();
  program.publish(entry({ made: 3 }));
  app.choose('searches/wave');
  app.advance(0);
  await program.last('search.open').answer(openedSearch());
  app.advance(200);
  await program.last('search.rows').answer(rowsFrom(0, [1, 3, 2]));
  app.chosen.value?.chooseCandidate(1);
  await program.last('search.candidate').answer({ number: 1, scores: [3], words, measures: {}, failure: null, given_up: false, reused: false });
  await program.pass(300);
  return { program, app };
}

describe('the part Search', () => {
  it('looks for searches every two seconds while it is shown, and never else', async () => {
    const { program, app } = appOf();
    const frames = async (from: number, to: number) => {
      for (let now = from; now < to; now += 16) {
        app.advance(now);
        const question = program.asked.at(-1);
        if (question?.name === 'search.refresh') await question.answer({});
      }
    };
    await frames(0, 10_000);
    assert.equal(program.ofName('search.refresh').length, 5);
    program.isShown.value = false;
    await frames(10_000, 20_000);
    assert.equal(program.ofName('search.refresh').length, 5);
    program.isShown.value = true;
    program.connect(false);
    await frames(20_000, 30_000);
    assert.equal(program.ofName('search.refresh').length, 5);
  });

  it('asks again when there is a connection again, also if an answer never came', async () => {
    const { program, app } = appOf();
    app.advance(0);
    program.connect(false);
    await program.last('search.refresh').refuse('the connection was lost before the answer');
    program.connect(true);
    app.advance(5000);
    assert.equal(program.ofName('search.refresh').length, 2);
  });

  it('shows a search that was started at once', async () => {
    const { program, app } = appOf();
    program.publish();
    app.form.open();
    app.form.preset.value = null;
    const started = app.start();
    await settle();
    await program.last('search.check').answer({ names: [], candidates: 1, planned: 501, text: '', engine: 'ode', reduced: null });
    await program.last('search.start').answer({ name: 'searches/cma_es_distance' });
    await started;
    assert.equal(program.host.chosenSearch.value, 'searches/cma_es_distance');
    app.advance(100);
    assert.equal(program.ofName('search.refresh').length, 1);
  });

  it('opens the form with defaults as soon as the program has said what can be in it', () => {
    const { program, app } = appOf();
    const { searchMethods } = program.state;
    const known = searchMethods.value;
    searchMethods.value = null;
    app.form.open();
    const method = () => app.form.experiment.value?.method;
    assert.equal(method(), undefined);
    searchMethods.value = known;
    assert.equal(method(), 'cmaEs');
  });

  it('stops a search, and goes on with more evaluations; a refusal is shown', async () => {
    const { program, app } = await withCandidate();
    void app.stop();
    assert.deepEqual(program.last('search.stop').words, { name: 'searches/wave' });
    await program.last('search.stop').answer({});
    assert.equal(app.problem.value, null);
    void app.resume('4000');
    assert.deepEqual(program.last('search.resume').words, { name: 'searches/wave', evaluations: '4000', workers: 2 });
    await program.last('search.resume').refuse('found another build');
    assert.equal(app.problem.value, 'found another build');
    app.choose(null);
    assert.equal(app.problem.value, null);
  });

  it('plays the chosen candidate', async () => {
    const { program } = await withCandidate();
    for (const { answer } of program.ofName('search.motion')) await answer(motionBytes());
    assert.ok(Math.abs((program.host.motion.value?.duration ?? 0) - 0.03) < 1e-9);
  });

  it('shows no candidate of another search', async () => {
    const { program, app } = await withCandidate();
    const before = app.chosen.value;
    app.choose('searches/other');
    assert.notEqual(app.chosen.value, before);
    assert.equal(app.chosen.value?.number.value, null);
    assert.equal(program.host.motion.value, null);
  });

  it('puts the values of a candidate into the draft, as one change with a name', async () => {
    const { program, app } = await withCandidate();
    await app.apply();
    assert.deepEqual(program.applied, [{ words, label: 'candidate 1 of wave' }]);
    program.refusal = 'Other parts have come or gone meanwhile.';
    await app.apply();
    assert.equal(app.chosen.value?.candidateProblem.value, 'Other parts have come or gone meanwhile.');
  });
});
