// The page Make: a world is made by clicks and drags, foreseen, simulated and saved; what it saves is what the command line reads.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { cpSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, describe, it } from 'node:test';
import { seriousProblems } from './support/accessibility.js';
import { assertNothingIsCut } from './support/layout.js';
import { useUi } from './support/ui_fixture.js';
import { program, UiProgram } from './support/ui_program.js';
import { waitUntil } from './support/waiting.js';
import { lostConnection } from './support/viewer.js';

describe('the page Make', () => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-page-'));
  cpSync('sim/scenarios/travelling_wave', join(folder, 'mine'), { recursive: true });
  const scenario = join(folder, 'mine/uniform.simulation.xml');
  const worldFile = join(folder, 'mine/flat.environment.xml');
  const original = readFileSync(worldFile, 'utf8');
  const ui = useUi(() => UiProgram.start(scenario, ['--recordings', folder]), { takesControl: true });

  after(() => rmSync(folder, { recursive: true }));

  const page = () => ui.viewer.page;
  const objects = () => page().getByRole('region', { name: 'Objects' });
  const field = (name: string) => objects().getByRole('textbox', { name, exact: true });
  const state = async () => page().getByTestId('draft-state').textContent();
  const foresight = async () => (await page().getByTestId('foresight').textContent()) ?? '';
  const add = async (item: string) => {
    await page().getByRole('region', { name: 'Library' }).getByRole('button', { name: item, exact: true }).click();
    await page().getByRole('button', { name: `Add ${item}` }).click();
    await objects().getByRole('button', { name: item, exact: true, pressed: true }).waitFor();
  };
  const rowCount = () => objects().getByRole('listitem').count();

  it('is loaded when it is shown, and shows the world and the next half minute', async () => {
    await page().keyboard.press('3');
    await page().getByTestId('map-top').waitFor();
    assert.equal(await rowCount(), 1);
    assert.ok(await waitUntil(async () => /^ ?The next half minute: 1\.\d\d m in 30 s, straight ahead/.test(await foresight())), await foresight());
    assert.equal(await state(), 'saved');
  });

  it('adds an object of the library in front of the robot, and foresees what that changes', async () => {
    const before = await foresight();
    await add('box');
    await field('size z in m').fill('0,3');
    await field('size z in m').press('Enter');
    assert.ok(await waitUntil(async () => (await field('size z in m').inputValue()) === '0.3'));
    await page().locator('.foresight-text:not(.old)').waitFor();
    assert.ok(await waitUntil(async () => (await foresight()) !== before && !/computing/.test(await foresight())));
    const blocked = Number(/: (\d\.\d\d) m/.exec(await foresight())?.[1]);
    assert.ok(blocked < 1, `${blocked} m behind a wall of 30 cm`);
    assert.equal(await state(), '1 file changed');
    assert.equal(readFileSync(worldFile, 'utf8'), original, 'nothing on disk changes before Save');
  });

  it('drags an object on the map; the drag is one entry of undo', async () => {
    const x = Number(await field('x in m').inputValue());
    const box = await page().locator('[data-testid=map-top] .object.chosen polygon').boundingBox();
    assert.ok(box !== null);
    await page().mouse.move(box.x + box.width / 4, box.y + box.height / 2);
    await page().mouse.down();
    await page().mouse.move(box.x + box.width / 4 + 80, box.y + box.height / 2, { steps: 8 });
    await page().mouse.up();
    assert.ok(await waitUntil(async () => Number(await field('x in m').inputValue()) > x + 0.1), await field('x in m').inputValue());
    await page().keyboard.press('Control+z');
    assert.ok(await waitUntil(async () => Number(await field('x in m').inputValue()) === x));
    await page().keyboard.press('Control+y');
    assert.ok(await waitUntil(async () => Number(await field('x in m').inputValue()) > x + 0.1));
  });

  it('moves and turns the chosen object with the keyboard', async () => {
    const x = Number(await field('x in m').inputValue());
    await page().getByTestId('map-top').focus();
    await page().keyboard.press('ArrowLeft');
    assert.ok(await waitUntil(async () => Math.abs(Number(await field('x in m').inputValue()) - (x - 0.1)) < 1e-6), await field('x in m').inputValue());
    await page().keyboard.press('PageUp');
    assert.ok(await waitUntil(async () => (await field('turn in °').inputValue()) === '5'), await field('turn in °').inputValue());
  });

  it('says at the field what is wrong, and changes nothing', async () => {
    const before = await field('friction').inputValue();
    await field('friction').fill('-1');
    await field('friction').press('Enter');
    await objects().getByRole('alert').filter({ hasText: '-1' }).waitFor();
    await field('friction').fill('grip');
    await field('friction').press('Enter');
    await objects().getByRole('alert').filter({ hasText: 'expected a number' }).waitFor();
    await field('friction').fill(before);
    await field('friction').press('Enter');
    assert.ok(await waitUntil(async () => (await objects().getByRole('alert').count()) === 0));
  });

  it('moves a group as one, duplicates it and deletes it', async () => {
    await add('stairs');
    await objects().getByText('One of 3 parts').waitFor();
    await objects().getByRole('button', { name: 'Duplicate' }).click();
    assert.ok(await waitUntil(async () => (await rowCount()) === 4), `${await rowCount()} rows`);
    await page().getByTestId('map-top').focus();
    await page().keyboard.press('Delete');
    assert.ok(await waitUntil(async () => (await rowCount()) === 3));
    await page().keyboard.press('Control+z');
    assert.ok(await waitUntil(async () => (await rowCount()) === 4), 'undo brings it back');
    await page().keyboard.press('Control+z');
    await page().keyboard.press('Control+z');
    assert.ok(await waitUntil(async () => (await rowCount()) === 2));
  });

  it('changes how the scenario is run, and says what cannot be', async () => {
    await page().getByRole('tab', { name: 'Run' }).click();
    const run = page().getByRole('region', { name: 'Run' });
    const tick = run.getByRole('textbox', { name: 'tick in ms' });
    await tick.fill('7,3');
    await tick.press('Enter');
    await run.getByRole('alert').filter({ hasText: 'a whole number of steps' }).waitFor();
    await tick.fill('20');
    await tick.press('Enter');
    assert.ok(await waitUntil(async () => (await state()) === '2 files changed'));
    await page().getByTestId('map-top').focus();
    await page().keyboard.press('Control+z');
    assert.ok(await waitUntil(async () => (await tick.inputValue()) === '10'));
    await page().getByRole('tab', { name: 'World' }).click();
  });

  it('simulates the draft on the page Live before it is saved', async () => {
    await page().getByRole('button', { name: 'Simulate' }).click();
    await page().getByRole('navigation').locator('[aria-current=page]', { hasText: 'Live' }).waitFor();
    await page().keyboard.press('x');
    await page().getByText('is of a draft that is not saved').first().waitFor();
    await page().keyboard.press('x');
    await page().keyboard.press('3');
  });

  it('saves exactly the lines that it shows; the command line reads the same world', async () => {
    await page().keyboard.press('Control+s');
    const panel = page().getByTestId('save-panel');
    await panel.locator('ins').first().waitFor();
    assert.equal(await panel.locator('del').count(), 0, 'an object was added, nothing else');
    const lines = (await panel.locator('ins').allTextContents()).join('\n');
    await panel.getByRole('button', { name: 'Save', exact: true }).click();
    assert.ok(await waitUntil(async () => (await state()) === 'saved'));
    const saved = readFileSync(worldFile, 'utf8');
    assert.equal(saved.replace(`${lines}\n`, ''), original);
    await page().locator('.foresight-text:not(.old)').waitFor(); // of this revision
    const engine = /ODE/.test(await foresight()) ? 'ode' : 'reduced';
    const distance = /: (\d\.\d\d) m/.exec(await foresight())?.[1];
    const json = execFileSync(program, ['simulate', scenario, '--engine', engine, '--json'], { encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] });
    assert.equal((JSON.parse(json) as { measures: { distance: number } }).measures.distance.toFixed(2), distance);
  });

  it('never overwrites a file that has changed on disk; a copy keeps both', async () => {
    writeFileSync(worldFile, `${readFileSync(worldFile, 'utf8')}<!-- by hand -->\n`);
    await objects().getByRole('button', { name: 'box', exact: true }).click();
    await page().getByTestId('map-top').focus();
    await page().keyboard.press('ArrowRight');
    await page().keyboard.press('Control+s');
    const panel = page().getByTestId('save-panel');
    await panel.getByRole('button', { name: 'Save', exact: true }).click();
    await panel.getByText('has changed since this program read it').waitFor();
    assert.match(readFileSync(worldFile, 'utf8'), /by hand/);
    await panel.getByPlaceholder('its name').fill('copy');
    await panel.getByRole('button', { name: 'Save a copy' }).click();
    assert.ok(await waitUntil(async () => (await state()) === 'saved'));
    assert.doesNotMatch(readFileSync(join(folder, 'copy/flat.environment.xml'), 'utf8'), /by hand/);
    execFileSync(program, ['simulate', join(folder, 'copy/uniform.simulation.xml'), '--seconds', '1'], { stdio: 'ignore' });
  });

  it('only shows to those who do not drive', async () => {
    const other = await ui.look();
    await other.page.keyboard.press('3');
    await other.page.getByTestId('map-top').waitFor();
    await other.page.getByText('Take control first').first().waitFor();
    assert.equal(await other.page.getByRole('button', { name: 'Simulate' }).isDisabled(), true);
    await other.page.getByRole('button', { name: 'box', exact: true }).first().click();
    assert.equal(await other.page.getByRole('button', { name: 'Add box' }).isDisabled(), true);
  });

  for (const width of [1366, 600, 360]) {
    it(`fits a window ${width} pixels wide, and screen readers`, async () => {
      await page().setViewportSize({ width, height: 800 });
      await assertNothingIsCut(ui.viewer);
      assert.deepEqual(await seriousProblems(ui.viewer), []);
      await page().screenshot({ path: `build/page_test/make_${width}.png`, fullPage: true });
    });
  }
});

describe('unsaved changes', () => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-page-'));
  cpSync('sim/scenarios/travelling_wave', folder, { recursive: true });
  const start = () => UiProgram.start(join(folder, 'uniform.simulation.xml'), ['--recordings', folder]);
  const ui = useUi(start, { isPerTest: true, takesControl: true });

  after(() => rmSync(folder, { recursive: true }));

  const journal = join(folder, '.uniform.simulation.xml.unsaved');
  const kept = () => (existsSync(journal) ? readFileSync(journal, 'utf8') : '');

  it('are kept when the program is killed in the middle of a drag', async () => {
    const { page } = ui.viewer;
    ui.viewer.expected.push(lostConnection);
    await page.keyboard.press('3');
    await page.getByRole('region', { name: 'Library' }).getByRole('button', { name: 'sphere', exact: true }).click();
    await page.getByRole('button', { name: 'Add sphere' }).click();
    const sphere = page.locator('[data-testid=map-top] .object.chosen polygon');
    await sphere.waitFor();
    const box = await sphere.boundingBox();
    assert.ok(box !== null);
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + 100, box.y + box.height / 2, { steps: 10 });
    assert.ok(await waitUntil(() => Promise.resolve(/KinBody name=\\"sphere/.test(kept()))));
    process.kill(ui.program.pid, 'SIGKILL');
    await page.getByTestId('connection-band').waitFor();
  });

  it('are offered at the next start, and can be restored', async () => {
    const { page } = ui.viewer;
    await page.keyboard.press('3');
    await page.getByTestId('unsaved').getByRole('button', { name: 'Restore' }).click();
    await page.getByRole('region', { name: 'Objects' }).getByRole('button', { name: 'sphere', exact: true }).waitFor();
    assert.equal(await page.getByTestId('unsaved').count(), 0);
    await page.keyboard.press('Control+z');
    assert.ok(await waitUntil(async () => (await page.getByTestId('draft-state').textContent()) === 'saved'), 'undo goes back to the files');
  });
});
