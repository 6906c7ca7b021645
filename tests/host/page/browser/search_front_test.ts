// The Pareto front of a search with two objectives, in the part Search of the page Make.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { cpSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, describe, it } from 'node:test';
import { seriousProblems } from './support/accessibility.js';
import { assertNothingIsCut } from './support/layout.js';
import { countPixelsWhen } from './support/pixels.js';
import { useUi } from './support/ui_fixture.js';
import { program, UiProgram } from './support/ui_program.js';
import { waitUntil } from './support/waiting.js';

// The orange of the front, light and dark.
const isFront = (red: number, green: number, blue: number) => red > blue + 90 && red > green + 40;

interface Row {
  number: number;
  gains: number[]; // scores, of which higher is better
}

// The evaluations that have both scores, as the folder of the search has them.
function rowsOf(search: string, signs: readonly number[]): Row[] {
  const [head, ...lines] = readFileSync(join(search, 'evaluations.tsv'), 'utf8').trimEnd().split('\n').map((line) => line.split('\t'));
  const place = (is: (name: string) => boolean) => head!.findIndex(is);
  const scores = head!.flatMap((name, column) => (name.startsWith('score:') ? [column] : []));
  assert.equal(scores.length, 2);
  const [number, failure] = [place((name) => name === 'evaluation'), place((name) => name === 'failure')];
  return lines
    .filter((cells) => cells[failure] === '' && scores.every((column) => cells[column] !== ''))
    .map((cells) => ({ number: Number(cells[number]), gains: scores.map((column, i) => signs[i]! * Number(cells[column])) }));
}

function nonDominated(rows: readonly Row[]): number[] {
  const dominates = (a: Row, b: Row) => a.gains.every((gain, i) => gain >= b.gains[i]!) && a.gains.some((gain, i) => gain > b.gains[i]!);
  return rows.filter((row) => !rows.some((other) => dominates(other, row))).map(({ number }) => number);
}

describe('a search with two objectives', () => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-page-'));
  const search = join(folder, 'searches/two');
  const start = () => {
    cpSync('sim/scenarios/travelling_wave', join(folder, 'mine'), { recursive: true });
    execFileSync(program, ['optimise', join(folder, 'mine/pareto.optimise.xml'), '--engine', 'reduced', '--evaluations', '200', '--out', search], { stdio: 'ignore' });
    return UiProgram.start(join(folder, 'mine/uniform.simulation.xml'), ['--recordings', folder]);
  };
  const ui = useUi(start, { takesControl: true });

  after(() => rmSync(folder, { recursive: true, maxRetries: 20, retryDelay: 100 }));

  const page = () => ui.viewer.page;
  const chosen = () => page().getByTestId('chosen-search');
  const chart = () => chosen().getByTestId('front-chart');
  const listed = async () => (await chosen().getByTestId('candidates').locator('tbody tr', { hasText: 'front' }).locator('button').allTextContents()).map(Number);

  it('marks the candidates that no other is better than in both scores', async () => {
    await page().keyboard.press('3');
    await page().getByRole('tab', { name: 'Search', exact: true }).click();
    await page().getByTestId('searches').getByRole('button', { name: 'two' }).click();
    await chart().waitFor();
    const title = (await chart().getAttribute('aria-label')) ?? '';
    const ways = [...title.matchAll(/(higher|lower) is better/g)].map(([, way]) => (way === 'higher' ? 1 : -1));
    assert.equal(ways.length, 2, title);
    const expected = nonDominated(rowsOf(search, ways.reverse())); // the title begins with the second one
    assert.ok(expected.length > 1);
    await chosen().getByRole('button', { name: 'Pareto front' }).click();
    assert.ok(await waitUntil(async () => (await listed()).length >= expected.length), `${(await listed()).join()}, expected ${expected.join()}`);
    assert.deepEqual((await listed()).sort((a, b) => a - b), expected);
    await chosen().getByText(`Pareto front: ${expected.length} candidates`).waitFor();
    assert.ok((await countPixelsWhen(page(), chart(), isFront, (count) => count > 150)) > 150, 'the front');
  });

  it('shows the candidate whose point is clicked, and the one that the keyboard chooses', async () => {
    const box = (await chart().boundingBox())!;
    const places = Array.from({ length: 40 * 20 }, (_, i) => ({ x: 60 + ((i % 40) / 40) * (box.width - 70), y: 10 + (Math.floor(i / 40) / 20) * (box.height - 46) }));
    const titles = await chart().evaluate(
      (canvas, all) =>
        all.map(({ x, y }) => {
          const corner = canvas.getBoundingClientRect();
          canvas.dispatchEvent(new PointerEvent('pointermove', { clientX: corner.left + x, clientY: corner.top + y }));
          return (canvas as HTMLElement).title;
        }),
      places,
    );
    const place = titles.findIndex((title) => title !== '');
    assert.ok(place >= 0, 'no point under the mouse');
    await chart().click({ position: places[place]! });
    const number = titles[place]!.replace('candidate ', '');
    await page().getByTestId('candidate').getByRole('heading', { name: `Candidate ${number} of` }).waitFor();
    const button = chosen().getByTestId('candidates').locator('tbody tr', { hasText: 'front' }).locator('button').last();
    await button.focus();
    await page().keyboard.press('Enter');
    await page().getByTestId('candidate').getByRole('heading', { name: `Candidate ${(await button.textContent()) ?? ''} of` }).waitFor();
    await chosen().getByTestId('motion-time').waitFor();
  });

  for (const colorScheme of ['light', 'dark'] as const) {
    for (const width of [1366, 768, 390]) {
      it(`fits a ${colorScheme} window ${width} pixels wide, and screen readers`, async () => {
        await page().emulateMedia({ colorScheme });
        await page().setViewportSize({ width, height: 800 });
        if (!(await chosen().isVisible())) await page().getByTestId('searches').getByRole('button', { name: 'two' }).click();
        assert.ok((await countPixelsWhen(page(), chart(), isFront, (count) => count > 150)) > 150, 'the front');
        await assertNothingIsCut(ui.viewer);
        assert.deepEqual(await seriousProblems(ui.viewer), []);
        await chart().scrollIntoViewIfNeeded();
        await page().screenshot({ path: `build/page_test/make_front_${colorScheme}_${width}.png`, fullPage: true });
        await chart().screenshot({ path: `build/page_test/make_front_${colorScheme}_${width}_chart.png` });
      });
    }
  }
});
