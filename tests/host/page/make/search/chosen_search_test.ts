import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { ChosenSearch } from '../../../../../host/page/source/make/search/chosen_search.js';
import { entry, openedSearch, rowsFrom, SearchProgram, settle } from '../../support/search_program.js';

const candidate = (number: number) => ({ number, scores: [1], words: [`amplitude:J5=${number}`], measures: {}, failure: null, given_up: false, reused: false });

async function shown(part = {}) {
  const program = new SearchProgram();
  const search = new ChosenSearch(program.host, 'searches/wave');
  search.advance(0, entry({ made: 3 }));
  await program.last('search.open').answer(openedSearch(part));
  search.advance(100, entry({ made: 3 }));
  await program.last('search.rows').answer(rowsFrom(0, [1, 3, 2]));
  search.advance(200, entry({ made: 3 }));
  return { program, search };
}

describe('a search that is shown', () => {
  it('is opened, then its evaluations are read', async () => {
    const { program, search } = await shown();
    assert.deepEqual(program.asked.map(({ name }) => name), ['search.open', 'search.rows']);
    assert.equal(search.shownCount.value, 3);
    assert.deepEqual(search.ranking.value?.best, [1, 2, 0]);
  });

  it('changes tables and charts at most twice a second', async () => {
    const { program, search } = await shown();
    let changes = 0;
    search.shownCount.subscribe(() => (changes += 1));
    for (let now = 1100, made = 3; now < 11_100; now += 20) {
      search.advance(now, entry({ made: 2000 }));
      const question = program.last('search.rows');
      if (question.words['from'] === made) {
        await question.answer(rowsFrom(made, [1, 2], 2000));
        made += 2;
      }
    }
    assert.ok(changes > 10 && changes <= 22, `${changes} changes in ten seconds`);
  });

  it('is opened again when it has ended: it has a result then; the evaluations stay', async () => {
    const { program, search } = await shown();
    search.advance(2000, entry({ made: 3, state: 'ended' }));
    await program.last('search.open').answer(openedSearch({ result: { best_number: 1 } as never }));
    assert.equal(search.opened.value?.result?.best_number, 1);
    assert.equal(program.ofName('search.open').length, 2);
    search.advance(2500, entry({ made: 3, state: 'ended' }));
    assert.equal(search.shownCount.value, 3);
    assert.equal(program.ofName('search.open').length, 2);
  });

  it('that cannot be opened says why, and is tried again after two seconds', async () => {
    const program = new SearchProgram();
    const search = new ChosenSearch(program.host, 'searches/wave');
    search.advance(0, entry());
    await program.last('search.open').refuse('the store is locked');
    assert.equal(search.problem.value, 'the store is locked');
    search.advance(1900, entry());
    assert.equal(program.asked.length, 1);
    search.advance(2000, entry());
    await program.last('search.open').answer(openedSearch());
    assert.equal(search.problem.value, null);
  });

  it('that cannot be read, or is not there, is not asked for', () => {
    const program = new SearchProgram();
    const search = new ChosenSearch(program.host, 'searches/wave');
    search.advance(0, entry({ state: 'unreadable' }));
    search.advance(5000, undefined);
    assert.equal(program.asked.length, 0);
  });

  it('reads the evaluations of another repetition anew', async () => {
    const { program, search } = await shown({ runs: 3 });
    search.chooseCandidate(1);
    search.chooseRun(2);
    assert.deepEqual([search.shownCount.value, search.number.value], [0, null]);
    search.advance(2000, entry({ made: 3 }));
    assert.deepEqual(program.last('search.rows').words, { name: 'searches/wave', run: 2, from: 0 });
  });

  it('drops what comes after another search was chosen', async () => {
    const program = new SearchProgram();
    const search = new ChosenSearch(program.host, 'searches/wave');
    search.advance(0, entry());
    search.close();
    await program.last('search.open').answer(openedSearch());
    assert.equal(search.opened.value, null);
  });
});

describe('the chosen candidate', () => {
  it('is the newest one that was clicked', async () => {
    const { program, search } = await shown();
    search.chooseCandidate(1);
    search.chooseCandidate(2);
    const [first, second] = program.ofName('search.candidate');
    assert.deepEqual(second?.words, { name: 'searches/wave', run: 0, number: 2 });
    await second?.answer(candidate(2));
    await first?.answer(candidate(1));
    assert.equal(search.candidate.value?.number, 2);
  });

  it('is confirmed when that is asked for; the answer for another one is dropped', async () => {
    const { program, search } = await shown();
    search.chooseCandidate(1);
    const done = search.confirm();
    void search.confirm();
    assert.equal(search.confirmation.value, 'running');
    assert.equal(program.ofName('search.confirm').length, 1);
    const answer = { nothing_speaks_against: true, findings: [{ name: 'energy', good: true, text: 'contacts gave nothing' }] };
    await program.last('search.confirm').answer(answer);
    await done;
    assert.deepEqual(search.confirmation.value, answer);
    search.chooseCandidate(2);
    assert.equal(search.confirmation.value, null);
    void search.confirm();
    search.chooseCandidate(1);
    await program.last('search.confirm').answer(answer);
    assert.equal(search.confirmation.value, null);
    void search.confirm();
    await program.last('search.confirm').refuse('another estimate or confirmation was asked for');
    assert.deepEqual([search.confirmation.value, search.candidateProblem.value], [null, 'another estimate or confirmation was asked for']);
  });

  it('keeps the answers when another search was chosen meanwhile', async () => {
    const { program } = await shown();
    const kept = new Map();
    const first = new ChosenSearch(program.host, 'searches/wave', kept);
    first.chooseCandidate(1);
    const done = first.confirm();
    const answer = { nothing_speaks_against: true, findings: [] };
    first.close();
    await program.last('search.confirm').answer(answer);
    await done;
    const again = new ChosenSearch(program.host, 'searches/wave', kept);
    again.chooseCandidate(1);
    assert.deepEqual(again.confirmation.value, answer);
    again.chooseCandidate(2);
    assert.equal(again.confirmation.value, null);
    const other = new ChosenSearch(program.host, 'searches/other', kept);
    other.chooseCandidate(1);
    assert.equal(other.confirmation.value, null);
  });

  it('that is not there says why', async () => {
    const { program, search } = await shown();
    search.chooseCandidate(7_000_000);
    await program.last('search.candidate').refuse('found 7000000, expected 0 to 2');
    assert.equal(search.candidateProblem.value, 'found 7000000, expected 0 to 2');
    search.chooseCandidate(1);
    await settle();
    assert.equal(search.candidateProblem.value, null);
  });
});

describe('a search with a map of gaits', () => {
  const axis = { name: 'height', unit: 'm', lowest: 0, highest: 1, cells: 2 };
  const objective = { name: 'distance', unit: 'm', maximise: true };
  const trial = { cell: '1,2', values: [0], expected: 1, deviation: 0.1, measured: 0.9, failure: null };
  const newest = { name: 'a', robot: 'one.simulation.xml', trials: [trial] };
  const other = { name: 'b', robot: 'two.simulation.xml', trials: [] };

  async function shownMap() {
    const program = new SearchProgram();
    const search = new ChosenSearch(program.host, 'searches/wave');
    search.advance(0, entry({ made: 2 }));
    await program.last('search.open').answer(openedSearch({ objectives: [objective, objective, objective], axes: [axis, axis] }));
    search.advance(100, entry({ made: 2 }));
    await program.last('search.rows').answer({ from: 0, made: 2, scores: [[1, 0.2, 0.9], [2, 0.9, 0.9]], values: [[0], [1]], flags: [0, 0] });
    search.advance(700, entry({ made: 2 }));
    return { program, search };
  }

  it('has the best of each cell', async () => {
    const { search } = await shownMap();
    const { map } = search.rows.value!;
    assert.deepEqual([...map!.elites].map(([cell, row]) => [map!.nameOf(cell), row]), [['1,2', 0], ['2,2', 1]]);
    assert.equal((await shown()).search.rows.value?.map, null, 'a search without one');
  });

  it('shows the trials of the newest adaptation, of one that was chosen, or of none', async () => {
    const { program, search } = await shownMap();
    assert.equal(search.adaptation.value, null);
    await program.last('search.adaptations').answer({ adaptations: [newest, other] });
    assert.equal(search.adaptation.value, newest);
    search.chooseAdaptation('b');
    assert.equal(search.adaptation.value, other);
    search.chooseAdaptation('');
    assert.equal(search.adaptation.value, null);
    search.advance(3000, entry({ made: 2 }));
    await program.last('search.adaptations').answer({ adaptations: [other, newest] });
    assert.equal(search.adaptation.value, null, 'none was chosen');
  });

  it('asks for adaptations again while it is shown, and keeps them when the answer does not come', async () => {
    const { program, search } = await shownMap();
    await program.last('search.adaptations').answer({ adaptations: [newest] });
    const before = search.adaptations.value;
    for (let now = 1000; now < 5000; now += 100) search.advance(now, entry({ made: 2 }));
    assert.ok(program.ofName('search.adaptations').length >= 2);
    await program.last('search.adaptations').answer({ adaptations: [{ ...newest }] });
    assert.equal(search.adaptations.value, before, 'nothing is drawn again for the same answer');
    await program.last('search.adaptations').refuse('no connection');
    assert.equal(search.adaptations.value, before);
  });

  it('asks for no adaptations without a map', async () => {
    const { program, search } = await shown();
    search.advance(9000, entry({ made: 3 }));
    assert.equal(program.ofName('search.adaptations').length, 0);
  });
});
