import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { NewSweep } from '../../../../../host/page/source/make/sweep/new_sweep.js';
import type { SweepCheck } from '../../../../../host/page/source/wire/messages.js';
import { SearchProgram, settle } from '../../support/search_program.js';

const soon = 300; // milliseconds, longer than the form waits
const good: SweepCheck = { runs: 9, counts: [9], has_equal_seeds: false, engine: 'ode', reduced: null };

async function openForm() {
  const program = new SearchProgram();
  program.state.sweeps.value = { processors: 2, sweeps: [] };
  const form = new NewSweep(program.host, program.after);
  form.open();
  const check = async (answer: SweepCheck = good) => {
    await program.pass(soon);
    await program.last('sweep.check').answer(answer);
  };
  const over = () => program.last('sweep.check').words['over'];
  return { program, form, check, over };
}

describe('the form of a new sweep', () => {
  it('begins with the amplitude of all joints over its useful range, and is started by a click', async () => {
    const { program, form, check, over } = await openForm();
    await check();
    assert.deepEqual(over(), ['amplitude=0:60:7.5']);
    await check(); // with the reduced engine, now that it is known that it can
    await program.last('sweep.estimate').answer({ run_s: 0.5, seconds: 2.25 });
    assert.equal(form.duration.value, (9 * 0.5) / 2);
    const started = form.start();
    await settle();
    assert.deepEqual(program.last('sweep.start').words, { over: ['amplitude=0:60:7.5'], measure: 'distance', engine: 'reduced', workers: 2, name: 'amplitude_distance' });
    await program.last('sweep.start').answer({ name: 'sweeps/amplitude_distance' });
    assert.equal(await started, 'sweeps/amplitude_distance');
    assert.equal(form.isOpen.value, false);
  });

  it('names joints, the world and seeds as `proleg sweep --over` does, with decimal points', async () => {
    const { form, check, over } = await openForm();
    form.change(0, { joint: 'J3', first: '1,5', last: '3', step: '0,5' });
    form.quantities.value = [...form.quantities.value, { kind: 'friction', module: 0, parameter: '', joint: null, first: '0.1', last: '0.3', step: '0.1' }];
    form.seeds.value = '5';
    await check();
    assert.deepEqual(over(), ['amplitude:J3=1.5:3:0.5', 'friction=0.1:0.3:0.1', 'seed=1:5']);
  });

  it('says at the quantity, or at the seeds, what is wrong, and does not start', async () => {
    const { program, form, check } = await openForm();
    form.seeds.value = 'x';
    await check({ problem: { field: 'over.1', text: 'found' }, engine: 'ode', reduced: 'no' });
    assert.equal(form.problem.value?.field, 'seeds');
    assert.equal(await form.start(), null);
    assert.equal(program.ofName('sweep.start').length, 0);
    form.seeds.value = '2';
    await check({ problem: { field: 'over.0', text: 'found' }, engine: 'ode', reduced: 'no' });
    assert.equal(form.problem.value?.field, 'over.0');
  });

  it('asks nothing while nothing changes', async () => {
    const { program, check } = await openForm();
    await check();
    await check();
    const before = program.ofName('sweep.check').length;
    for (let i = 0; i < 10; i += 1) await program.pass(soon);
    assert.equal(program.ofName('sweep.check').length, before);
  });

  it('says why a start was refused', async () => {
    const { program, form, check } = await openForm();
    await check();
    await check();
    const started = form.start();
    await settle();
    await program.last('sweep.start').refuse("name: found 'x', which exists, expected a new name");
    assert.equal(await started, null);
    assert.deepEqual(form.problem.value, { field: 'name', text: "found 'x', which exists, expected a new name" });
  });
});
