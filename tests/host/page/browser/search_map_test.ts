// The map of gaits of a search with MAP-Elites, and the trials of an adaptation on it, in the part Search of the page Make.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, describe, it } from 'node:test';
import { seriousProblems } from './support/accessibility.js';
import { assertNothingIsCut } from './support/layout.js';
import { countPixelsWhen } from './support/pixels.js';
import { useUi } from './support/ui_fixture.js';
import { program, UiProgram } from './support/ui_program.js';
import { waitUntil } from './support/waiting.js';

// The blue of the cells, light and dark.
const isCell = (red: number, green: number, blue: number) => blue > red + 60 && blue > green;

function table(file: string): Record<string, string>[] {
  const lines = readFileSync(file, 'utf8').trimEnd().split('\n').filter((line) => !line.startsWith('#')).map((line) => line.split('\t'));
  const head = lines.shift()!;
  return lines.map((cells) => Object.fromEntries(head.map((name, column) => [name.split(' (')[0]!, cells[column] ?? ''])));
}

describe('a search with a map of gaits', () => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-page-'));
  const atlas = join(folder, 'searches/atlas');
  const adapted = join(folder, 'jammed');
  const start = () => {
    cpSync('sim/scenarios/travelling_wave', join(folder, 'mine'), { recursive: true });
    execFileSync(program, ['atlas', join(folder, 'mine/gait_map.optimise.xml'), '--evaluations', '600', '--out', atlas], { stdio: 'ignore' });
    const scenario = join(folder, 'mine/uniform.simulation.xml');
    execFileSync(program, ['adapt', scenario, '--atlas', atlas, '--trials', '5', '--alpha', '1', '--damage', 'jammed:J3=20', '--engine', 'reduced', '--out', adapted], { stdio: 'ignore' });
    const text = readFileSync(join(folder, 'mine/gait_map.optimise.xml'), 'utf8').replace(/ cells="\d+"/g, '').replace('<first>', '<centroids>60</centroids><first>');
    writeFileSync(join(folder, 'mine/round.optimise.xml'), text);
    execFileSync(program, ['atlas', join(folder, 'mine/round.optimise.xml'), '--evaluations', '200', '--out', join(folder, 'searches/round')], { stdio: 'ignore' });
    return UiProgram.start(scenario, ['--recordings', folder]);
  };
  const ui = useUi(start, { takesControl: true });

  after(() => rmSync(folder, { recursive: true, maxRetries: 20, retryDelay: 100 }));

  const page = () => ui.viewer.page;
  const chosen = () => page().getByTestId('chosen-search');
  const map = () => chosen().getByTestId('gait-map');
  const told = async () => (await chosen().getByTestId('map-cell').textContent()) ?? '';
  const heading = (row: number | string) => page().getByTestId('candidate').getByRole('heading', { name: `Candidate ${row} of` });
  // The filled cells, as the folder of the search has them.
  const filled = () => table(join(atlas, 'map.tsv'));

  it('shows the filled cells of the map', async () => {
    await page().keyboard.press('3');
    await page().getByRole('tab', { name: 'Search', exact: true }).click();
    await page().getByTestId('searches').getByRole('button', { name: 'atlas' }).click();
    await map().waitFor();
    await chosen().getByText(`${filled().length} of 500 cells are filled`).waitFor();
    assert.ok((await countPixelsWhen(page(), map(), isCell, (count) => count > 1000)) > 1000, 'the cells');
  });

  it('chooses the gait of the cell that is clicked', async () => {
    const canvas = map().locator('canvas');
    const box = (await canvas.boundingBox())!;
    let number = '';
    for (let place = 0; place < 25 * 20 && number === ''; place += 1) {
      const position = { x: 62 + ((place % 25) + 0.5) * ((box.width - 74) / 25), y: 10 + (Math.floor(place / 25) + 0.5) * ((box.height - 46) / 20) };
      await page().mouse.move(box.x + position.x, box.y + position.y);
      const found = /^Cell (\S+): distance .*, candidate (\d+)$/.exec(await told());
      if (found === null) continue;
      number = found[2]!;
      const row = filled().find((cell) => `${cell['cell:height']},${cell['cell:duty_factor']}` === found[1]);
      assert.equal(row?.['evaluation'], number, JSON.stringify(row));
      await canvas.click({ position });
    }
    await heading(number).waitFor();
    await chosen().getByTestId('motion-time').waitFor();
  });

  it('goes from cell to cell by the keyboard', async () => {
    await page().mouse.move(1, 1);
    await map().focus();
    const first = await told();
    for (const key of ['ArrowRight', 'ArrowUp', 'ArrowRight', 'ArrowDown', 'ArrowLeft', 'ArrowLeft']) await page().keyboard.press(key);
    assert.ok(await waitUntil(async () => /^Cell /.test(await told()) && (await told()) !== first), await told());
    const number = /candidate (\d+)$/.exec(await told())![1]!;
    await page().keyboard.press('Enter');
    await heading(number).waitFor();
  });

  it('has the trials of the adaptation with this map, and shows the gait of each', async () => {
    const trials = table(join(adapted, 'trials.tsv'));
    assert.equal(trials.length, 5);
    const rows = chosen().getByTestId('trials').locator('tbody tr');
    assert.ok(await waitUntil(async () => (await rows.count()) === 5));
    await chosen().getByText('uniform.simulation.xml, jammed:J3=20').waitFor();
    for (const [place, trial] of trials.entries()) {
      const cells = await rows.nth(place).locator('td').allTextContents();
      assert.equal(cells[0], trial['cell']);
      assert.equal(Number(cells[2]), Number(Number(trial['measured']).toPrecision(4)));
    }
    assert.match((await chosen().getByTestId('diagnosis').textContent())!, /^Probable damage: jammed:J3=20 \d+ %/);
    for (const [place, trial] of trials.entries()) {
      const button = rows.nth(place).getByRole('button');
      const number = /^Candidate (\d+)$/.exec((await button.getAttribute('title'))!)![1]!;
      const best = filled().find((cell) => `${cell['cell:height']},${cell['cell:duty_factor']}` === trial['cell'])!;
      const isBest = Object.keys(best).every((name) => !name.startsWith('amplitude') || Number(best[name]) === Number(trial[name]));
      assert.equal(number === best['evaluation'], isBest, `trial ${place + 1}: ${JSON.stringify(best)}`);
      await button.click();
      await heading(number).waitFor();
    }
    await chosen().getByRole('combobox', { name: 'trials of' }).selectOption('none');
    assert.ok(await waitUntil(async () => (await rows.count()) === 0));
    await chosen().getByRole('combobox', { name: 'trials of' }).selectOption('jammed');
    assert.ok(await waitUntil(async () => (await rows.count()) === 5));
  });

  it('has the cells around centroids, each with the gait that the folder of the search has there', async () => {
    const rows = table(join(folder, 'searches/round/map.tsv'));
    await page().getByTestId('searches').getByRole('button', { name: 'round' }).click();
    await chosen().getByText(`${rows.length} of 60 cells are filled`).waitFor();
    const seen = new Map<string, string>();
    await map().focus();
    for (const key of ['ArrowUp', 'ArrowLeft', 'ArrowDown', 'ArrowRight', 'ArrowDown', 'ArrowRight', 'ArrowRight', 'ArrowUp']) {
      await page().keyboard.press(key);
      const found = /^Cell (\d+): distance .*, candidate (\d+)$/.exec(await told());
      if (found !== null) seen.set(found[1]!, found[2]!);
    }
    assert.ok(seen.size >= 3, [...seen].join());
    for (const [cell, number] of seen) assert.equal(rows.find((row) => row['cell:number'] === cell)?.['evaluation'], number, `cell ${cell}`);
    assert.equal(await chosen().getByTestId('trials').count(), 0, 'trials of another map');
    await map().screenshot({ path: 'build/page_test/make_map_centroids.png' });
    await page().getByTestId('searches').getByRole('button', { name: 'atlas' }).click();
    await chosen().getByTestId('trials').waitFor();
  });

  for (const colorScheme of ['light', 'dark'] as const) {
    for (const width of [1366, 768, 390]) {
      it(`fits a ${colorScheme} window ${width} pixels wide, and screen readers`, async () => {
        await page().emulateMedia({ colorScheme });
        await page().setViewportSize({ width, height: 800 });
        if (!(await chosen().isVisible())) await page().getByTestId('searches').getByRole('button', { name: 'atlas' }).click();
        assert.ok((await countPixelsWhen(page(), map(), isCell, (count) => count > 300)) > 300, 'the cells');
        await assertNothingIsCut(ui.viewer);
        assert.deepEqual(await seriousProblems(ui.viewer), []);
        await map().scrollIntoViewIfNeeded();
        await page().screenshot({ path: `build/page_test/make_map_${colorScheme}_${width}.png`, fullPage: true });
        await map().screenshot({ path: `build/page_test/make_map_${colorScheme}_${width}_map.png` });
      });
    }
  }
});
