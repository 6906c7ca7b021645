// Sweeps in the part Search of the page Make: from a form to a map, and from a cell into the draft.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { cpSync, existsSync, mkdtempSync, readdirSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, describe, it } from 'node:test';
import { seriousProblems } from './support/accessibility.js';
import { assertNothingIsCut } from './support/layout.js';
import { countPixelsWhen, isBlue } from './support/pixels.js';
import { useUi } from './support/ui_fixture.js';
import { program, UiProgram } from './support/ui_program.js';
import { waitUntil } from './support/waiting.js';

const isGhost = (red: number, green: number, blue: number) => green > red + 12 && green > blue + 4;

describe('a sweep', () => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-page-'));
  const sweeps = join(folder, 'sweeps');
  const start = () => {
    cpSync('sim/scenarios/travelling_wave', join(folder, 'mine'), { recursive: true });
    // From a shell: one quantity with seeds, and a map with many cells.
    const shell = (out: string, seconds: string, ...words: string[]) =>
      execFileSync(program, ['sweep', join(folder, 'mine/coupled.simulation.xml'), '--seconds', seconds, '--engine', 'reduced', '--out', join(folder, out), ...words], { stdio: 'ignore' });
    shell('line', '2', '--over', 'amplitude=10:50:5', '--over', 'seed=1:5');
    shell('large', '0.2', '--over', 'amplitude=10:50:1', '--over', 'phase_difference=20:120:2');
    return UiProgram.start(join(folder, 'mine/uniform.simulation.xml'), ['--recordings', folder]);
  };
  const ui = useUi(start, { takesControl: true });

  after(() => {
    for (const name of existsSync(sweeps) ? readdirSync(sweeps) : []) rmSync(join(sweeps, name), { recursive: true, maxRetries: 20, retryDelay: 100 });
    rmSync(folder, { recursive: true, maxRetries: 20, retryDelay: 100 });
  });

  const page = () => ui.viewer.page;
  const part = () => page().getByRole('region', { name: 'Sweeps', exact: true });
  const form = () => page().getByTestId('sweep-form');
  const chosen = () => page().getByTestId('chosen-sweep');
  const picture = () => chosen().getByTestId('sweep-picture');
  const text = async () => (await chosen().getByTestId('cell-text').textContent()) ?? '';
  const summary = async () => (await page().getByTestId('sweep-summary').textContent()) ?? '';
  const cell = () => page().getByTestId('sweep-cell');
  const isState = async (expected: RegExp) => {
    const state = async () => (await chosen().getByTestId('sweep-state').textContent()) ?? '';
    assert.ok(await waitUntil(async () => expected.test(await state())), await state());
  };

  it('begins with a form that is a sensible sweep already, and says how long it takes', async () => {
    await page().keyboard.press('3');
    await page().getByRole('tab', { name: 'Search', exact: true }).click();
    await part().getByRole('button', { name: 'New sweep …' }).click();
    assert.ok(await waitUntil(async () => /^9 runs; about \d+ s/.test(await summary())), await summary());
    assert.ok(!existsSync(sweeps), 'nothing is written before the start');
  });

  it('says at the field what is wrong; a decimal comma is not', async () => {
    const problem = form().getByRole('alert');
    await form().locator('input[name="over.0.last"]').fill('-5');
    await form().getByRole('group', { name: 'Quantity 1' }).getByRole('alert').filter({ hasText: 'expected an ascending range' }).waitFor();
    await form().locator('input[name="over.0.first"]').fill('20');
    await form().locator('input[name="over.0.last"]').fill('40');
    await form().locator('input[name="over.0.step"]').fill('0,0001');
    await problem.filter({ hasText: 'at most 100000 runs' }).waitFor();
    await form().locator('input[name="over.0.step"]').fill('5,0');
    assert.ok(await waitUntil(async () => (await problem.count()) === 0 && /^5 runs/.test(await summary())), await summary());
    await form().locator('input[name="seeds"]').fill('x');
    await problem.filter({ hasText: 'found' }).waitFor();
    await form().locator('input[name="seeds"]').fill('2');
    assert.ok(await waitUntil(async () => /^10 runs.*all seeds give the same run/.test(await summary())), await summary());
    await form().locator('input[name="seeds"]').fill('1');
  });

  it('of two quantities is started by a click, and becomes a map', async () => {
    await form().getByRole('button', { name: 'Add a second quantity' }).click();
    await form().getByRole('group', { name: 'Quantity 2' }).getByRole('combobox', { name: 'quantity' }).selectOption({ label: '1. sinusoidal: frequency' });
    await form().locator('input[name="over.1.first"]').fill('0.4');
    await form().locator('input[name="over.1.last"]').fill('1');
    await form().locator('input[name="over.1.step"]').fill('0.2');
    assert.ok(await waitUntil(async () => /^20 runs/.test(await summary())), await summary());
    await assertNothingIsCut(ui.viewer);
    assert.deepEqual(await seriousProblems(ui.viewer), []);
    await page().screenshot({ path: 'build/page_test/make_sweep_form.png', fullPage: true });
    await form().locator('input[name="name"]').fill('map');
    await form().getByRole('button', { name: 'Start', exact: true }).click();
    await isState(/^ended, 20 of 20 runs/);
    await picture().waitFor();
    assert.ok((await countPixelsWhen(page(), picture(), isBlue, (count) => count > 5000)) > 5000, 'cells');
    await chosen().getByTestId('colour-legend').waitFor();
  });

  it('names the cell that its table of runs says is the best', async () => {
    const [, , head, ...lines] = readFileSync(join(sweeps, 'map/sweep.tsv'), 'utf8').trimEnd().split('\n').map((line) => line.split('\t'));
    const column = head!.indexOf('distance (m)');
    const best = lines.reduce((a, b) => (Number(b[column]) > Number(a[column]) ? b : a));
    await chosen().getByTestId('best-cell').getByText(`Best: amplitude ${best[0]!} deg, frequency ${best[1]!} Hz: ${String(Number(Number(best[column]).toPrecision(5)))} m`).waitFor();
    const row = chosen().getByTestId('cells').locator('tbody tr').first();
    assert.deepEqual((await row.locator('td').allTextContents()).slice(0, 2), [best[0], best[1]]);
  });

  it('tells the value of a cell under the mouse, and of the one that the keyboard goes to', async () => {
    const box = (await picture().boundingBox())!;
    await page().mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    assert.ok(await waitUntil(async () => /^amplitude \d+ deg, frequency [\d.]+ Hz: [\d.e-]+ m/.test(await text())), await text());
    await page().mouse.move(0, 0);
    await picture().focus();
    for (const key of ['ArrowLeft', 'ArrowLeft', 'ArrowLeft', 'ArrowLeft', 'ArrowLeft', 'ArrowDown', 'ArrowDown', 'ArrowDown', 'ArrowDown']) await page().keyboard.press(key);
    assert.ok(await waitUntil(async () => (await text()).startsWith('amplitude 20 deg, frequency 0.4 Hz: ')), await text());
    await page().keyboard.press('ArrowRight');
    await page().keyboard.press('Enter');
    await cell().getByRole('heading', { name: 'amplitude 25 deg, frequency 0.4 Hz of sweeps/map' }).waitFor();
  });

  it('shows the gait of a cell beside the present one, and puts its values into the draft as one change', async () => {
    await picture().click({ position: { x: 75, y: 20 } }); // the first column, the highest row
    await cell().getByRole('heading', { name: 'amplitude 20 deg, frequency 1 Hz of sweeps/map' }).waitFor();
    await chosen().getByTestId('motion-time').waitFor();
    const scene = page().getByTestId('scene').last();
    assert.ok((await countPixelsWhen(page(), scene, isGhost, (count) => count > 200)) > 200, 'the ghost');
    await page().screenshot({ path: 'build/page_test/make_sweep.png', fullPage: true });
    await cell().getByRole('button', { name: 'Apply' }).click();
    await cell().getByText('The draft has these values').waitFor();
    const undo = page().getByRole('button', { name: 'Undo', exact: true });
    assert.match((await undo.getAttribute('title')) ?? '', /^Undo: amplitude 20 deg, frequency 1 Hz of map/);
    await undo.click();
    await cell().getByText('The draft has these values').waitFor({ state: 'detached' });
  });

  it('shows another measure of the same runs', async () => {
    await chosen().getByRole('combobox', { name: 'measure' }).selectOption('cost_of_transport');
    await chosen().getByTestId('cells').getByRole('columnheader', { name: /^cost_of_transport/ }).waitFor();
  });

  it('of one quantity is a line with the standard deviations, also one from a shell', async () => {
    await part().getByTestId('sweeps').getByRole('button', { name: 'line' }).click();
    await chosen().getByText('with its standard deviation over the seeds').waitFor();
    assert.ok((await countPixelsWhen(page(), picture(), isBlue, (count) => count > 200)) > 200, 'the line');
    await picture().focus();
    await page().keyboard.press('ArrowRight');
    assert.ok(await waitUntil(async () => /standard deviation [\d.e-]+, 5 values/.test(await text())), await text());
    await page().screenshot({ path: 'build/page_test/make_sweep_line.png', fullPage: true });
  });

  it('is stopped, and goes on', async () => {
    await part().getByRole('button', { name: 'New sweep …' }).click();
    await form().getByRole('button', { name: 'Begin anew' }).click();
    await form().locator('input[name="over.0.first"]').fill('10');
    await form().locator('input[name="over.0.last"]').fill('50');
    await form().locator('input[name="over.0.step"]').fill('0.01');
    await form().locator('input[name="name"]').fill('long');
    await form().getByRole('button', { name: 'Start', exact: true }).click();
    await isState(/^running, [1-9]/);
    await chosen().getByRole('button', { name: 'Stop', exact: true }).click();
    await isState(/^interrupted, /);
    await chosen().getByTestId('best-cell').waitFor();
    await chosen().getByRole('button', { name: 'Continue' }).click();
    await isState(/^running, [1-9]/);
    await chosen().getByRole('button', { name: 'Stop', exact: true }).click();
    await isState(/^interrupted, /);
  });

  it('is only shown to those who do not drive', async () => {
    const other = await ui.look();
    await other.page.keyboard.press('3');
    await other.page.getByRole('tab', { name: 'Search', exact: true }).click();
    await other.page.getByTestId('sweeps').getByRole('button', { name: 'map' }).click();
    await other.page.getByTestId('cells').locator('tbody tr button').first().click();
    await other.page.getByTestId('candidate-values').waitFor();
    assert.equal(await other.page.getByTestId('sweep-cell').getByRole('button', { name: 'Apply' }).isDisabled(), true);
  });

  for (const colorScheme of ['light', 'dark'] as const) {
    for (const width of [1366, 768, 390]) {
      it(`fits a ${colorScheme} window ${width} pixels wide, and screen readers`, async () => {
        await page().emulateMedia({ colorScheme });
        await page().setViewportSize({ width, height: 800 });
        await chosen().getByRole('button', { name: 'Close' }).click();
        await part().getByTestId('sweeps').getByRole('button', { name: width === 768 ? 'large' : 'map' }).click();
        await chosen().getByTestId('cells').locator('tbody tr button').first().click();
        assert.ok((await countPixelsWhen(page(), picture(), isBlue, (count) => count > 2000)) > 2000, 'cells');
        await assertNothingIsCut(ui.viewer);
        assert.deepEqual(await seriousProblems(ui.viewer), []);
        await page().screenshot({ path: `build/page_test/make_sweep_${colorScheme}_${width}.png`, fullPage: true });
      });
    }
  }
});
