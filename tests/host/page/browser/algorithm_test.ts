// The part Algorithm of the page Make: from a form to a robot that moves by an algorithm of one's own, without a command line.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, describe, it } from 'node:test';
import { seriousProblems } from './support/accessibility.js';
import { assertNothingIsCut } from './support/layout.js';
import { useUi } from './support/ui_fixture.js';
import { program, UiProgram } from './support/ui_program.js';
import { waitUntil } from './support/waiting.js';

describe("an algorithm of one's own", () => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-page-'));
  cpSync('sim/scenarios/travelling_wave', join(folder, 'mine'), { recursive: true });
  const actuationFile = join(folder, 'mine/uniform.actuation.xml');
  const sourceFile = join(folder, 'my_wave/my_wave.cpp');
  const start = () => UiProgram.start(join(folder, 'mine/uniform.simulation.xml'), ['--recordings', folder]);
  const ui = useUi(start, { takesControl: true });

  after(() => rmSync(folder, { recursive: true }));

  const page = () => ui.viewer.page;
  const part = () => page().getByRole('region', { name: 'Algorithm', exact: true });
  const form = () => page().getByTestId('algorithm-form');
  const code = () => part().getByRole('textbox', { name: 'Source of my_wave' });
  const state = async () => part().getByTestId('algorithm-state').textContent();
  const buildText = async () => (await part().getByTestId('algorithm-build').textContent()) ?? '';
  const isInEditor = () => page().evaluate(() => document.activeElement?.closest('.code') !== null);
  const messages = () => part().getByRole('list', { name: 'Messages of the build' });
  const build = async (expected: RegExp) => {
    await part().getByRole('button', { name: 'Build', exact: true }).click();
    await part().getByText(/^The build begins|^Building/).waitFor(); // what the one before has said is gone
    assert.ok(await waitUntil(async () => /failed|loaded|cancelled/.test(await buildText())), await buildText());
    assert.match(`${await buildText()} ${(await messages().allTextContents()).join('; ')}`, expected);
  };
  // Waits for the end of what says how far it is: each step has its time.
  const untilTheEnd = async (text: () => Promise<string>, goesOn: RegExp) => {
    for (let before = await text(); goesOn.test(before); before = await text()) {
      const shown = before;
      assert.ok(await waitUntil(async () => (await text()) !== shown), shown);
    }
  };
  const simulate = async () => {
    await page().getByRole('button', { name: 'Simulate', exact: true }).click();
    await page().getByRole('navigation').locator('[aria-current=page]', { hasText: 'Live' }).waitFor();
  };

  it('begins with a form, which says at the field what is wrong', async () => {
    await page().keyboard.press('3');
    await page().getByRole('tab', { name: 'Algorithm', exact: true }).click();
    await part().getByRole('button', { name: 'New algorithm …' }).click();
    await form().locator('input[name=name]').fill('class');
    await form().locator('input[name="parameters.1.default"]').fill('21');
    await form().getByRole('button', { name: 'Write the source' }).click();
    await form().locator('label', { hasText: 'a name that C++' }).locator('input[name=name]').waitFor();
    await form().locator('input[name=name]').fill('my_wave');
    await form().getByRole('button', { name: 'Write the source' }).click();
    await form().locator('label', { hasText: 'expected 0 to 20' }).locator('input[name="parameters.1.default"]').waitFor();
    await page().screenshot({ path: 'build/page_test/algorithm_form.png', fullPage: true });
    await form().locator('input[name="parameters.1.default"]').fill('0,5');
    await form().getByRole('button', { name: 'Write the source' }).click();
    await code().waitFor();
    assert.match(readFileSync(sourceFile, 'utf8'), /Parameter\{"frequency", Unit::hertz, raw\(Unit::hertz, 1, 2\), 0,/);
    assert.match((await code().textContent()) ?? '', /my_wave: an actuation algorithm for Proleg/);
  });

  it('is written in an editor, which the keyboard can leave', async () => {
    await code().click();
    await page().keyboard.press('Control+End');
    await page().keyboard.press('Enter');
    await page().keyboard.type('int = 3; // x 3 ?');
    assert.ok(await waitUntil(async () => (await state()) === 'not saved'));
    assert.equal(await part().count(), 1, 'letters, blanks and digits are text here');
    await page().keyboard.press('Control+s');
    assert.ok(await waitUntil(async () => (await state()) === 'saved'));
    assert.match(readFileSync(sourceFile, 'utf8'), /\nint = 3; \/\/ x 3 \?$/);
    assert.equal(await page().getByTestId('save-panel').count(), 0, 'it saves the source, not the draft');
    await page().keyboard.press('Tab');
    assert.equal(await isInEditor(), true, 'Tab indents');
    await page().keyboard.press('Shift+Tab');
    assert.equal(await isInEditor(), true);
    await page().keyboard.press('Control+m');
    await page().keyboard.press('Tab');
    assert.equal(await isInEditor(), false);
    await code().focus();
    await page().keyboard.press('Control+m');
  });

  it('shows an error at its line', async () => {
    const line = readFileSync(sourceFile, 'utf8').split('\n').length;
    await build(/^The build failed: \d error/);
    const error = messages().getByRole('button', { name: `line ${line}: error: ` }).first();
    await error.waitFor();
    assert.ok((await part().locator('.cm-lint-marker-error').count()) >= 1);
    await page().screenshot({ path: 'build/page_test/algorithm_error.png', fullPage: true });
    await error.click();
    assert.ok(await waitUntil(isInEditor));
    await page().keyboard.press('Control+Shift+K'); // deletes the line
    assert.ok(await waitUntil(async () => (await state()) === 'not saved'));
  });

  it('is built, and moves the robot of a scenario that names it', async () => {
    await build(/^Built and loaded/);
    assert.equal(await messages().count(), 0);
    const before = readFileSync(actuationFile, 'utf8');
    writeFileSync(actuationFile, before.replace('PatternGenerator_sinusoidal', 'my_wave'));
    await page().keyboard.press('1');
    await page().keyboard.press('3'); // the draft takes over what is on disk
    assert.ok(
      await waitUntil(async () => {
        await simulate();
        const isThere = (await page().getByText('steepness').count()) > 0;
        if (!isThere) await page().keyboard.press('3');
        return isThere;
      }),
    );
    await page().keyboard.press('k');
    assert.ok(await waitUntil(async () => Number(await page().getByTestId('tick').textContent()) > 20));
    await page().keyboard.press('k');
  });

  it('says that it loops for ever', async () => {
    const source = readFileSync(sourceFile, 'utf8');
    const begin = '    next[current_phase] = add_wrapping';
    assert.ok(source.includes(begin));
    writeFileSync(sourceFile, source.replace(begin, `    for (volatile int i = 0;; i = i + 1) {\n    }\n${begin}`));
    await page().keyboard.press('3');
    await part().getByRole('button', { name: 'my_wave', exact: true }).click();
    await code().getByText('volatile int i').waitFor();
    await build(/^Built and loaded/);
    await simulate();
    await page().keyboard.press('k');
    await page().getByText("the algorithm 'my_wave' does not return within a second of processor time: an endless loop?").first().waitFor();
    await page().keyboard.press('3');
    await part().getByTestId('algorithm-failure').waitFor();
    // On a busy computer the loop takes longer than the page waits for an answer: it connects again, without control.
    await ui.viewer.takeControl();
    writeFileSync(sourceFile, source);
    await part().getByRole('button', { name: 'my_wave', exact: true }).click();
    await code().getByText('volatile int i').waitFor({ state: 'detached' });
    await build(/^Built and loaded/);
    await page().keyboard.press('1');
    await page().getByRole('button', { name: 'Restart', exact: true }).click();
    await ui.viewer.waitForState('paused');
    await page().keyboard.press('k');
    assert.ok(await waitUntil(async () => Number(await page().getByTestId('tick').textContent()) > 20), 'Restart uses the new version');
    await page().keyboard.press('k');
  });

  it('never overwrites a source that has changed on disk', async () => {
    await page().keyboard.press('3');
    await code().click();
    await page().keyboard.press('Control+End');
    await page().keyboard.type('// typed');
    const other = `${readFileSync(sourceFile, 'utf8')}// by another editor\n`;
    writeFileSync(sourceFile, other);
    await page().keyboard.press('Control+s');
    await part().getByRole('alert').filter({ hasText: 'has changed since it was read' }).waitFor();
    assert.equal(readFileSync(sourceFile, 'utf8'), other);
    assert.equal(await state(), 'not saved', 'what was typed is still there');
    await part().getByRole('button', { name: 'Open the file again' }).click();
    await code().getByText('by another editor').waitFor();
    assert.equal(await state(), 'saved');
  });

  it('is proven, with what it costs on the chip beside the builds', async () => {
    const check = part().getByRole('button', { name: 'Check', exact: true });
    const text = async () => (await part().getByTestId('algorithm-check').textContent()) ?? '';
    await check.click();
    assert.ok(await waitUntil(async () => /^Proving, step \d+ of \d+: /.test(await text())));
    await part().getByRole('progressbar', { name: 'Steps of the proof' }).waitFor();
    assert.equal(await check.isDisabled(), true);
    await part().getByRole('button', { name: 'Cancel my_wave' }).click();
    assert.ok(await waitUntil(async () => (await text()) === 'The proof was cancelled.'));
    await check.click();
    assert.ok(await waitUntil(async () => /^Proving/.test(await text())));
    await untilTheEnd(text, /^(The proof begins|Proving)/);
    assert.equal(await text(), 'Verified: the same bits everywhere.');
    const cost = part().getByTestId('proof-cost');
    assert.match((await cost.getByRole('row', { name: /^Cost/ }).textContent()) ?? '', /\d+ instructions a tick at worst.*2500 instructionsgood$/);
    assert.match((await cost.getByRole('row', { name: /^Stack/ }).textContent()) ?? '', /\d+ bytes at most.*512 bytesgood$/);
    const builds = part().getByTestId('proof-builds').locator('tbody tr');
    assert.equal(await builds.count(), 11);
    assert.match((await builds.filter({ hasText: 'Cortex-M4' }).textContent()) ?? '', /^Cortex-M4equal5 modules50000[0-9a-f]{24}$/);
    await page().screenshot({ path: 'build/page_test/algorithm_proof.png', fullPage: true });
  });

  it('comes into the image for the modules, with the command that flashes it', async () => {
    const image = part().getByRole('region', { name: 'Into the image' });
    const text = async () => (await image.getByTestId('image-state').textContent()) ?? '';
    const begin = image.getByRole('button', { name: 'Build the image' });
    assert.equal(await image.getByRole('checkbox', { name: 'my_wave' }).isChecked(), true);
    await image.getByRole('checkbox', { name: 'my_wave' }).uncheck();
    assert.equal(await begin.isDisabled(), true);
    await image.getByRole('checkbox', { name: 'my_wave' }).check();
    await begin.click();
    assert.ok(await waitUntil(async () => /^Building the image: \d+ of \d+ …$/.test(await text())));
    await image.getByRole('button', { name: 'Cancel the image' }).click();
    assert.ok(await waitUntil(async () => (await text()) === 'The build of the image was cancelled.'));
    await begin.click();
    assert.ok(await waitUntil(async () => /^(The build of the image begins|Building)/.test(await text())));
    await untilTheEnd(text, /^(The build of the image begins|Building)/);
    assert.equal(await text(), 'The image is built.');
    const file = join(folder, 'build/image/bin/proleg_stm32f405.pimg');
    assert.equal(await image.getByTestId('flash-command').textContent(), `proleg flash --bus can0 ${file}`);
    const { images } = JSON.parse(execFileSync(program, ['image', 'info', '--json', file], { encoding: 'utf8' })) as { images: { intact: boolean; sha256: string }[] };
    assert.equal(images[0]?.intact, true);
    const facts = image.getByTestId('image-facts');
    await facts.getByRole('row', { name: `SHA-256 ${images[0]?.sha256}` }).waitFor();
    assert.match((await facts.getByRole('row', { name: /^Flash/ }).textContent()) ?? '', /^Flash\d+ of 90112 bytes, \d+ are left$/);
    const sources = (await part().getByTestId('proof-builds').locator('caption').textContent())?.match(/0x[0-9A-F]{8}/)?.[0];
    assert.match((await facts.getByRole('row', { name: /^Contents/ }).textContent()) ?? '', new RegExp(`my_wave \\(sources ${sources}\\)$`));
    await page().screenshot({ path: 'build/page_test/algorithm_image.png', fullPage: true });
  });

  it('only shows to those who do not drive', async () => {
    const other = await ui.look();
    await other.page.keyboard.press('3');
    await other.page.getByRole('tab', { name: 'Algorithm', exact: true }).click();
    await other.page.getByRole('button', { name: 'my_wave', exact: true }).click();
    await other.page.getByRole('textbox', { name: 'Source of my_wave' }).waitFor();
    assert.equal(await other.page.getByRole('button', { name: 'Build', exact: true }).isDisabled(), true);
  });

  for (const width of [1366, 600, 360]) {
    it(`fits a window ${width} pixels wide, and screen readers`, async () => {
      await page().setViewportSize({ width, height: 800 });
      await assertNothingIsCut(ui.viewer);
      assert.deepEqual(await seriousProblems(ui.viewer), []);
      await page().screenshot({ path: `build/page_test/algorithm_${width}.png`, fullPage: true });
    });
  }
});
