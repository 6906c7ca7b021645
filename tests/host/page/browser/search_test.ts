// The part Search of the page Make: from a form to a better gait that is in the files, without a command line.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { cpSync, existsSync, mkdtempSync, readdirSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, describe, it } from 'node:test';
import { seriousProblems } from './support/accessibility.js';
import { assertNothingIsCut } from './support/layout.js';
import { countPixelsWhen } from './support/pixels.js';
import { useUi } from './support/ui_fixture.js';
import { program, UiProgram } from './support/ui_program.js';
import { waitUntil } from './support/waiting.js';
import { lostConnection } from './support/viewer.js';

// The green of the ghost, light and dark.
const isGhost = (red: number, green: number, blue: number) => green > red + 12 && green > blue + 4;

// A search outlives the program that has started it, and a test that fails.
function removeWithSearches(folder: string): void {
  const searches = join(folder, 'searches');
  for (const name of existsSync(searches) ? readdirSync(searches) : []) {
    try {
      execFileSync(program, ['optimise', '--stop', join(searches, name)], { stdio: 'ignore' });
    } catch {
      // It does not run.
    }
  }
  rmSync(folder, { recursive: true, maxRetries: 20, retryDelay: 100 });
}

describe('a search for a gait', () => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-page-'));
  cpSync('sim/scenarios/travelling_wave', join(folder, 'mine'), { recursive: true });
  const scenario = join(folder, 'mine/uniform.simulation.xml');
  const actuation = join(folder, 'mine/uniform.actuation.xml');
  const search = join(folder, 'searches/cma_es_distance');
  const ui = useUi(() => UiProgram.start(scenario, ['--recordings', folder]), { takesControl: true });

  after(() => removeWithSearches(folder));

  const page = () => ui.viewer.page;
  const part = () => page().getByRole('region', { name: 'Search', exact: true });
  const form = () => page().getByTestId('search-form');
  const field = (name: string) => form().locator(`input[name="${name}"]`);
  const summary = async () => (await page().getByTestId('search-summary').textContent()) ?? '';
  const chosen = () => page().getByTestId('chosen-search');
  const state = async () => (await chosen().getByTestId('search-state').textContent()) ?? '';
  const isState = async (expected: RegExp) => assert.ok(await waitUntil(async () => expected.test(await state())), await state());
  const candidate = () => page().getByTestId('candidate');
  const rows = () => chosen().getByTestId('candidates').locator('tbody tr');
  const motionTime = async () => Number(((await chosen().getByTestId('motion-time').textContent()) ?? '').replace(' s', ''));
  const result = () => JSON.parse(readFileSync(join(search, 'result.json'), 'utf8')) as { best_number: number; best_score: number; evaluations: number };
  const simulate = (file: string) => {
    const json = execFileSync(program, ['simulate', file, '--json'], { encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] });
    return (JSON.parse(json) as { measures: { distance: number } }).measures.distance;
  };
  const openForm = async () => {
    await part().getByRole('button', { name: 'New search …' }).click();
    await form().waitFor();
  };
  const experimentText = async () => (await form().locator('pre').textContent()) ?? '';

  it('begins with a form that is a sensible search already', async () => {
    await page().keyboard.press('3');
    await page().getByRole('tab', { name: 'Search', exact: true }).click();
    await part().getByText('There is no search yet').waitFor();
    await openForm();
    assert.equal(await form().getByRole('group', { name: /amplitude/ }).count(), 1);
    assert.deepEqual([await field('parameters.0.lower').inputValue(), await field('parameters.0.upper').inputValue()], ['0', '60']);
    // Half a minute is planned as soon as it is measured how long an evaluation takes.
    assert.ok(await waitUntil(async () => /possible candidates; [\d,]+ evaluations; about \d+ s/.test(await summary())), await summary());
    assert.notEqual(await field('evaluations').inputValue(), '500');
    assert.ok(!existsSync(join(folder, 'searches')), 'nothing is written before the start');
  });

  it('says at the field what is wrong; a decimal comma is not', async () => {
    await field('parameters.0.upper').fill('40,1');
    await form().locator('label', { hasText: /found/ }).locator('input[name="parameters.0.step"], input[name="parameters.0.upper"]').first().waitFor();
    await field('parameters.0.upper').fill('40,0');
    await field('parameters.0.step').fill('0,25');
    assert.ok(await waitUntil(async () => (await form().getByRole('alert').count()) === 0));
    assert.match(await experimentText(), /<upperBounds>40\.0<\/upperBounds>/);
  });

  it('has all that the dialogues of the thesis had for a genetic algorithm', async () => {
    const amplitude = form().getByRole('group', { name: '1. sinusoidal: amplitude' });
    const frequency = form().getByRole('group', { name: '1. sinusoidal: frequency' });
    await form().locator('select[name=method]').selectOption('geneticAlgorithm/');
    await form().getByText('Settings of the method').click();
    for (const [name, value] of [['popsize', '50'], ['pmut', '0,01'], ['pcross', '0,9'], ['nconvergence', '50'], ['pconvergence', '0,99']] as const) {
      await field(`settings.${name}`).fill(value);
    }
    await amplitude.getByRole('combobox', { name: 'joints', exact: true }).selectOption('chosen joints');
    await amplitude.getByRole('button', { name: 'J1', exact: true }).click();
    await amplitude.getByRole('combobox', { name: 'they have' }).selectOption('one value for all');
    await amplitude.getByRole('combobox', { name: 'upper limit inclusive or exclusive' }).selectOption('exclusive');
    await form().getByRole('button', { name: 'Add', exact: true }).click(); // the next parameter
    await frequency.getByRole('combobox', { name: 'out of' }).selectOption('explicit values');
    await field('parameters.1.set').fill('0,5, 1, 1,5');
    assert.ok(await waitUntil(async () => /<values>0\.5 1 1\.5<\/values>/.test(await experimentText())), await experimentText());
    const text = await experimentText();
    assert.match(text, /<geneticAlgorithm>/);
    assert.match(text, /<popsize>50<\/popsize>/);
    assert.match(text, /<pmut>0\.01<\/pmut>/);
    assert.match(text, /activeJoints="01111"/);
    assert.match(text, /<upperBoundTypes>2<\/upperBoundTypes>/);
    assert.match(text, /<uniform>1<\/uniform>/);
    await page().screenshot({ path: 'build/page_test/make_search_form.png', fullPage: true });
    await assertNothingIsCut(ui.viewer);
    assert.deepEqual(await seriousProblems(ui.viewer), []);
    await form().getByRole('button', { name: 'Begin anew' }).click();
  });

  it('stays when another part is shown', async () => {
    await field('evaluations').fill('60');
    await page().getByRole('tab', { name: 'World' }).click();
    await page().getByTestId('map-top').waitFor();
    await page().getByRole('tab', { name: 'Search', exact: true }).click();
    assert.equal(await field('evaluations').inputValue(), '60');
  });

  it('is started by a click, and shows its evaluations, its result and the best candidates', async () => {
    assert.ok(await waitUntil(async () => / 60 evaluations/.test(await summary())), await summary());
    await form().getByRole('button', { name: 'Start', exact: true }).click();
    await isState(/^ended, 60 of 60 evaluations/);
    await chosen().getByTestId('search-result').getByText(`The best is candidate ${result().best_number}: `).waitFor();
    await chosen().getByTestId('search-result').getByText('in ODE').waitFor();
    assert.ok(await waitUntil(async () => (await rows().count()) >= 20), `${await rows().count()} rows`);
    await part().getByTestId('searches').locator('tbody tr', { hasText: 'ended' }).waitFor();
    const curve = chosen().getByTestId('learning-curve');
    const isPoint = (red: number, _green: number, blue: number) => blue > red + 60;
    assert.ok((await countPixelsWhen(page(), curve, isPoint, (count) => count > 100)) > 100, 'points of evaluations');
  });

  it('sorts the candidates by any column, with the keyboard too', async () => {
    const head = chosen().getByTestId('candidates').locator('thead th').nth(2);
    await head.getByRole('button').focus();
    await page().keyboard.press('Enter');
    assert.equal(await head.getAttribute('aria-sort'), 'ascending');
    const values = (await chosen().getByTestId('candidates').locator('tbody td:nth-of-type(2)').allTextContents()).map(Number);
    assert.deepEqual(values, [...values].sort((a, b) => a - b));
  });

  it('plays the best beside the present gait, round and round', async () => {
    await chosen().getByRole('button', { name: 'Show the best' }).click();
    await candidate().getByRole('heading', { name: `Candidate ${result().best_number} of` }).waitFor();
    await chosen().getByTestId('motion-time').waitFor();
    assert.ok(await waitUntil(async () => (await motionTime()) > 1), String(await motionTime()));
    const scene = page().getByTestId('scene').last();
    assert.ok((await countPixelsWhen(page(), scene, isGhost, (count) => count > 200)) > 200, 'the ghost');
    await chosen().getByRole('button', { name: 'Pause' }).click();
    const slider = chosen().getByRole('slider', { name: 'Time of the motion' });
    await slider.fill('12.5');
    assert.ok(await waitUntil(async () => (await motionTime()) === 12.5), String(await motionTime()));
    await page().screenshot({ path: 'build/page_test/make_search.png', fullPage: true });
  });

  it('says whether the gait is real', async () => {
    await candidate().getByRole('button', { name: 'Is it real?' }).click();
    const confirmation = page().getByTestId('confirmation');
    await confirmation.waitFor();
    assert.match((await confirmation.textContent()) ?? '', /ok: a finer step|doubt: a finer step/);
    assert.deepEqual(await seriousProblems(ui.viewer), []);
  });

  it('puts the best into the draft; what is saved goes as far as the search has said, to the last bit', async () => {
    const before = readFileSync(actuation, 'utf8');
    await candidate().getByRole('button', { name: 'Apply' }).click();
    await candidate().getByText('The draft has these values').waitFor();
    await page().getByRole('button', { name: 'Undo', exact: true }).and(page().locator(`[title^="Undo: candidate ${result().best_number} of"]`)).waitFor();
    await page().keyboard.press('Control+s');
    const panel = page().getByTestId('save-panel');
    await panel.locator('ins').first().waitFor();
    const lines = (await panel.locator('ins').allTextContents()).join('\n');
    const shown = await candidate().getByTestId('candidate-values').locator('tbody tr').evaluateAll((all) => all.map((row) => [...row.children].map((cell) => cell.textContent ?? '')));
    assert.equal(shown.length, 5);
    for (const [name, value] of shown) {
      if (value !== '40') assert.ok(lines.includes(`value="${value}"`), `${name} = ${value} is not in ${lines}`);
    }
    assert.equal(readFileSync(actuation, 'utf8'), before, 'nothing on disk changes before Save');
    await panel.getByRole('button', { name: 'Save', exact: true }).click();
    await panel.waitFor({ state: 'detached' });
    assert.equal(simulate(scenario), result().best_score);
    assert.equal(simulate(join(search, 'best.simulation.xml')), result().best_score);
  });

  it('goes on with more evaluations', async () => {
    await chosen().getByRole('textbox', { name: 'evaluations' }).fill('100');
    await chosen().getByRole('button', { name: 'Continue' }).click();
    await isState(/^ended, 100 of 100 evaluations/);
    assert.ok(await waitUntil(() => result().evaluations === 100));
  });

  it('is stopped; what it has found stays, and the maps come back when it is closed', async () => {
    await openForm();
    await field('evaluations').fill('1000000');
    await field('name').fill('long');
    await form().getByRole('button', { name: 'Start', exact: true }).click();
    await chosen().getByRole('heading', { name: 'searches/long' }).waitFor();
    await isState(/^running, [1-9]/);
    await chosen().getByRole('button', { name: 'Stop', exact: true }).click();
    await isState(/^(interrupted|ended), /);
    assert.ok(await waitUntil(() => existsSync(join(folder, 'searches/long/best.simulation.xml'))), 'what it has found stays');
    await part().getByRole('button', { name: 'long' }).click();
    await page().getByTestId('map-top').waitFor();
  });

  it('begins from an experiment file, too', async () => {
    await part().getByRole('button', { name: 'From a file …' }).click();
    const file = page().getByRole('list', { name: 'Experiment files' }).getByRole('listitem').filter({ hasText: 'mine/cma_es' });
    await file.getByRole('button', { name: 'Into the form' }).click();
    assert.ok(await waitUntil(async () => (await field('evaluations').inputValue()) === '2000'));
    assert.equal(await field('settings.popsize').inputValue(), '32');
    assert.equal(await field('parameters.0.upper').inputValue(), '40');
    await form().getByRole('button', { name: 'Close' }).click();
  });

  it('is only shown to those who do not drive', async () => {
    const other = await ui.look();
    await other.page.keyboard.press('3');
    await other.page.getByRole('tab', { name: 'Search', exact: true }).click();
    await other.page.getByTestId('searches').getByRole('button', { name: 'cma_es_distance' }).click();
    await other.page.getByTestId('candidates').locator('tbody tr button').first().click();
    await other.page.getByTestId('candidate-values').waitFor();
    assert.equal(await other.page.getByTestId('candidate').getByRole('button', { name: 'Apply' }).isDisabled(), true);
    assert.equal(await other.page.getByRole('button', { name: 'Continue' }).isDisabled(), true);
  });

  for (const width of [1366, 600, 360]) {
    it(`fits a window ${width} pixels wide, and screen readers`, async () => {
      await page().setViewportSize({ width, height: 800 });
      if (!(await chosen().isVisible())) await part().getByRole('button', { name: 'cma_es_distance' }).click();
      await rows().first().getByRole('button').click();
      await candidate().getByTestId('candidate-values').waitFor();
      await assertNothingIsCut(ui.viewer);
      assert.deepEqual(await seriousProblems(ui.viewer), []);
      await page().screenshot({ path: `build/page_test/make_search_${width}.png`, fullPage: true });
    });
  }
});

describe('a search that goes on by itself', () => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-page-'));
  cpSync('sim/scenarios/travelling_wave', join(folder, 'mine'), { recursive: true });
  const start = () => UiProgram.start(join(folder, 'mine/uniform.simulation.xml'), ['--recordings', folder]);
  const ui = useUi(start, { isPerTest: true, takesControl: true });

  after(() => removeWithSearches(folder));

  it('is started from a file as it is, and the program is killed', async () => {
    const { page } = ui.viewer;
    ui.viewer.expected.push(lostConnection);
    await page.keyboard.press('3');
    await page.getByRole('tab', { name: 'Search', exact: true }).click();
    await page.getByRole('button', { name: 'From a file …' }).click();
    const file = page.getByRole('list', { name: 'Experiment files' }).getByRole('listitem').filter({ hasText: 'mine/great_deluge' });
    await file.getByRole('button', { name: 'Start' }).click();
    await page.getByTestId('search-state').filter({ hasText: /^running, [1-9]/ }).waitFor();
    await ui.program.kill();
    await page.getByTestId('connection-band').waitFor();
  });

  it('is found by the next program, which stops it', async () => {
    const { page } = ui.viewer;
    await page.keyboard.press('3');
    await page.getByRole('tab', { name: 'Search', exact: true }).click();
    await page.getByTestId('searches').getByRole('button', { name: 'great_deluge' }).click();
    await page.getByTestId('search-state').filter({ hasText: 'running' }).waitFor();
    await page.getByTestId('chosen-search').getByRole('button', { name: 'Stop', exact: true }).click();
    await page.getByTestId('search-state').filter({ hasText: /^(interrupted|ended)/ }).waitFor();
    await page.getByTestId('candidates').locator('tbody tr').first().waitFor();
  });
});
