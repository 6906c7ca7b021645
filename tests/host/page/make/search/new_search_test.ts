import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { NewSearch } from '../../../../../host/page/source/make/search/new_search.js';
import type { Experiment, SearchCheck } from '../../../../../host/page/source/wire/messages.js';
import { caterpillar, entry, SearchProgram, settle } from '../../support/search_program.js';

const soon = 300; // milliseconds, longer than the form waits
const good = { names: ['amplitude:J5'], candidates: 241 ** 5, planned: 501, text: '<cmaEs/>', engine: 'ode', reduced: null as string | null };

async function openForm(isHolder = true) {
  const program = new SearchProgram();
  program.drives = isHolder;
  program.publish();
  const form = new NewSearch(program.host, program.after);
  form.open();
  await program.pass(soon);
  const check = async (answer: SearchCheck = good) => {
    await program.pass(soon);
    await program.last('search.check').answer(answer);
  };
  return { program, form, check };
}

// The form as it is when a preset has measured: half a minute are 3800 evaluations.
async function measuredForm() {
  const all = await openForm();
  await all.check();
  await all.program.last('search.estimate').answer({ evaluation_s: 0.0078, planned: 501, seconds: 4, engine: 'reduced' });
  await all.check({ ...good, planned: 3801 });
  return all;
}

const experimentOf = ({ words }: { words: Record<string, unknown> }) => words['experiment'] as Experiment;

describe('the form of a new search', () => {
  it('begins with half a minute with the reduced engine and all processors: a click starts it', async () => {
    const { program, form } = await measuredForm();
    assert.deepEqual(program.last('search.estimate').words['engine'], 'reduced');
    assert.equal(form.experiment.value?.evaluations, '3800');
    assert.equal(Math.round(form.duration.value ?? 0), 30);
    const started = form.start();
    await settle();
    const { words } = program.last('search.start');
    assert.deepEqual({ ...words, experiment: undefined }, { name: 'cma_es_distance', engine: 'reduced', workers: 2, experiment: undefined });
    assert.equal(experimentOf(program.last('search.start')).evaluations, '3800');
    await program.last('search.start').answer({ name: 'searches/cma_es_distance' });
    assert.equal(await started, 'searches/cma_es_distance');
    assert.equal(form.isOpen.value, false);
  });

  it('is checked while it is edited: a while after the last change, with the numbers as the program reads them', async () => {
    const { program, form, check } = await measuredForm();
    const before = program.ofName('search.check').length;
    for (const upper of ['4', '40', '40,', '40,5']) {
      form.change({ parameters: [{ ...form.experiment.value!.parameters[0]!, upper }] });
      await program.pass(50);
    }
    assert.equal(program.ofName('search.check').length, before);
    await check();
    assert.equal(program.ofName('search.check').length, before + 1);
    assert.equal(experimentOf(program.last('search.check')).parameters[0]?.upper, '40.5');
    assert.equal(form.experiment.value?.parameters[0]?.upper, '40,5', 'what was typed stays');
  });

  it('says at the field what is wrong, and starts nothing then', async () => {
    const { program, form, check } = await measuredForm();
    form.change({ settings: { popsize: '2' } });
    const problem = { field: 'settings.popsize', text: 'found 2, expected at least 5' };
    await check({ problem });
    assert.deepEqual(form.problem.value, problem);
    assert.equal(form.check.value, null);
    assert.equal(await form.start(), null);
    assert.equal(program.ofName('search.start').length, 0);
    form.change({ settings: { popsize: '20' } });
    await check();
    assert.equal(form.problem.value, null);
  });

  it('that is started at once waits for the check and for the number of evaluations', async () => {
    const { program, form } = await openForm();
    const started = form.start();
    await settle();
    await program.last('search.check').answer(good);
    assert.equal(program.ofName('search.start').length, 0);
    await program.last('search.estimate').answer({ evaluation_s: 0.1, planned: 501, seconds: 50, engine: 'reduced' });
    await program.last('search.check').answer({ ...good, planned: 301 });
    assert.equal(experimentOf(program.last('search.start')).evaluations, '300');
    await program.last('search.start').answer({ name: 'searches/cma_es_distance' });
    assert.equal(await started, 'searches/cma_es_distance');
  });

  it('starts once, however often it is clicked', async () => {
    const { program, form } = await measuredForm();
    void form.start();
    void form.start();
    await settle();
    assert.equal(program.ofName('search.start').length, 1);
  });

  it('shows why the program did not start it', async () => {
    const { program, form } = await measuredForm();
    const started = form.start();
    await settle();
    await program.last('search.start').refuse("name: found 'cma_es_distance', expected the name of a new folder");
    assert.equal(await started, null);
    assert.deepEqual(form.problem.value, { field: 'name', text: "found 'cma_es_distance', expected the name of a new folder" });
    assert.equal(form.isOpen.value, true);
    form.change({ seed: '2' });
    assert.equal(form.problem.value, null);
  });

  it('says when the connection is lost, and checks again when it is back', async () => {
    const { program, form, check } = await measuredForm();
    form.change({ seed: '2' });
    await program.pass(soon);
    program.connect(false);
    await program.last('search.check').refuse('the connection was lost before the answer');
    assert.equal(form.problem.value?.text, 'the connection was lost before the answer');
    program.connect(true);
    await check();
    assert.equal(form.problem.value, null);
  });
});

describe('the time of a new search', () => {
  it('is measured once for all presets', async () => {
    const { program, form } = await measuredForm();
    form.choosePreset('night');
    assert.equal(form.experiment.value?.evaluations, '3600000');
    assert.equal(form.experiment.value?.settings['generations'], '180000', 'else the method would end before');
    form.choosePreset('five_minutes');
    assert.equal(form.experiment.value?.evaluations, '38000');
    assert.equal(program.ofName('search.estimate').length, 1);
  });

  it('is measured again when the engine, the trials or the scenario are others', async () => {
    const { program, form, check } = await measuredForm();
    form.engine.value = 'own';
    await settle();
    assert.equal(program.last('search.estimate').words['engine'], null);
    await program.last('search.estimate').answer({ evaluation_s: 0.25, planned: 1, seconds: 1, engine: 'ode' });
    await check();
    assert.equal(form.experiment.value?.evaluations, '120');
    program.draft.value = caterpillar({ revision: 2 });
    await check();
    assert.equal(program.ofName('search.estimate').length, 2, 'another value of the draft does not count');
    program.draft.value = caterpillar({ revision: 3, run: { ...caterpillar().run, duration: 60 } });
    await check();
    assert.equal(program.ofName('search.estimate').length, 3);
  });

  it('is not measured if the number of evaluations was typed', async () => {
    const { program, form, check } = await measuredForm();
    form.setEvaluations('60');
    form.engine.value = 'own';
    await check({ ...good, planned: 61 });
    assert.equal(program.ofName('search.estimate').length, 1);
    assert.equal(form.experiment.value?.evaluations, '60');
    assert.equal(form.duration.value, null, 'not known for this engine');
  });

  it('that cannot be measured is said once, and not asked for again and again', async () => {
    const { program, form, check } = await openForm();
    await check();
    await program.last('search.estimate').refuse('the robot fell over');
    assert.deepEqual(form.problem.value, { field: 'preset', text: 'the robot fell over' });
    form.change({ seed: '2' });
    await check();
    assert.equal(program.ofName('search.estimate').length, 1);
    form.choosePreset('half_minute');
    assert.equal(form.problem.value, null);
    assert.equal(program.ofName('search.estimate').length, 2);
  });

  it('is measured only by who drives', async () => {
    const { program, form, check } = await openForm(false);
    await check();
    assert.equal(program.ofName('search.estimate').length, 0);
    assert.equal(form.problem.value, null);
  });
});

describe('the engine of a new search', () => {
  it('is that of the scenario if the reduced one does not have such a world', async () => {
    const { form, check } = await openForm();
    assert.equal(form.chosenEngine.value, null);
    await check({ ...good, reduced: 'found a mesh' });
    assert.equal(form.chosenEngine.value, null);
  });

  it('stays while something else in the form is wrong', async () => {
    const { form, check } = await measuredForm();
    form.change({ seed: 'x' });
    await check({ problem: { field: 'seed', text: 'found x' } });
    assert.equal(form.chosenEngine.value, 'reduced');
  });
});

describe('the form of the next search', () => {
  it('has the experiment of the last one, with a name that is free', async () => {
    const { program, form } = await measuredForm();
    form.change({ seed: '7' });
    form.isOpen.value = false;
    program.publish(entry({ name: 'searches/cma_es_distance' }));
    form.open();
    assert.equal(form.experiment.value?.seed, '7');
    assert.equal(form.name.value, 'cma_es_distance_2');
    form.beginAnew();
    assert.equal(form.experiment.value?.seed, '1');
  });

  it('begins anew if the draft has none of its parameters', async () => {
    const { program, form } = await measuredForm();
    form.change({ seed: '7', parameters: [{ ...form.experiment.value!.parameters[0]!, module: 3 }] });
    form.isOpen.value = false;
    form.open();
    assert.deepEqual([form.experiment.value?.seed, form.experiment.value?.parameters[0]?.module], ['1', 0]);
    assert.equal(program.state.notices.value.length, 0);
  });

  it('is filled from an experiment file, whose evaluations it keeps', async () => {
    const { program, form, check } = await measuredForm();
    const read = form.read('/home/me/mine/cma_es.optimise.xml');
    await program.last('search.read').answer({ experiment: { ...form.experiment.value!, evaluations: '2000', seed: '9' } });
    assert.equal(await read, null);
    await check();
    assert.deepEqual([form.experiment.value?.evaluations, form.experiment.value?.seed, form.preset.value], ['2000', '9', null]);
    const refused = form.read('/home/me/mine/other.optimise.xml');
    await program.last('search.read').refuse('found 8 joints, expected 5');
    assert.equal(await refused, 'found 8 joints, expected 5');
    assert.equal(form.experiment.value?.seed, '9');
  });

  it('is not needed to start an experiment file as it is', async () => {
    const { program, form } = await measuredForm();
    program.publish(entry({ name: 'searches/cma_es' }));
    const started = form.startFile('/home/me/mine/cma_es.optimise.xml', 'mine/cma_es');
    assert.deepEqual(program.last('search.start').words, { name: 'cma_es_2', file: '/home/me/mine/cma_es.optimise.xml', engine: null, workers: 2 });
    await program.last('search.start').answer({ name: 'searches/cma_es_2' });
    assert.equal(await started, 'searches/cma_es_2');
  });
});
