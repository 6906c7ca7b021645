// A project with an algorithm of one's own is started again: the page builds what the scenario needs, after a click.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import type { Browser } from 'playwright-core';
import { seriousProblems } from './support/accessibility.js';
import { launchBrowser } from './support/browser.js';
import { resultOf, shownCommand } from './support/command_line.js';
import { assertNothingIsCut } from './support/layout.js';
import { program, UiProgram } from './support/ui_program.js';
import { lostConnection, Viewer } from './support/viewer.js';
import { waitUntil } from './support/waiting.js';

describe("a project with an algorithm of one's own", () => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-page-'));
  const sourceFile = join(folder, 'my_wave/my_wave.cpp');
  const library = join(folder, 'my_wave/build/my_wave.so');
  const scenario = join(folder, 'my_wave/robot/robot.simulation.xml');
  const journal = join(folder, 'my_wave/robot/.robot.simulation.xml.unsaved');
  let browser: Browser;
  let ui: UiProgram;
  let viewer: Viewer;

  const start = async (words: string[]) => {
    ui = await UiProgram.serve(words, { XDG_STATE_HOME: join(folder, 'state') });
    viewer = await Viewer.openAny(browser, ui.address);
    await viewer.takeControl();
  };

  before(async () => {
    execFileSync(program, ['new', 'algorithm', 'my_wave', '--out', join(folder, 'my_wave')]);
    browser = await launchBrowser();
    await start([folder]);
  });
  after(async () => {
    try {
      await viewer.close();
    } finally {
      await ui.end();
      await browser.close();
      rmSync(folder, { recursive: true });
    }
  });

  const page = () => viewer.page;
  const offer = () => page().getByTestId('algorithm-offer');
  const build = (then: string) => offer().getByRole('button', { name: `Build my_wave and ${then}` });
  const isShown = (name: string) => page().getByRole('navigation').locator('[aria-current=page]', { hasText: name }).waitFor();

  it('is opened without the algorithm, and nothing is built by itself', async () => {
    await page().getByRole('button', { name: 'Make', exact: true }).click();
    const entry = page().getByTestId('open-panel').getByRole('button', { name: 'my_wave/robot/robot', exact: true });
    await entry.getByText('Needs the algorithm my_wave, not loaded.').waitFor();
    await entry.click();
    await offer().getByText('needs the algorithm my_wave, which is not loaded.').waitFor();
    assert.equal(existsSync(join(folder, 'my_wave/build')), false);
    assert.equal(await page().getByText('found unknown algorithm').count(), 0, 'the offer says it');
    await page().screenshot({ path: 'build/page_test/algorithm_offer.png' });
    assert.deepEqual(await seriousProblems(viewer), []);
    for (const width of [360, 600, 1400]) {
      await page().setViewportSize({ width, height: 900 });
      await assertNothingIsCut(viewer);
    }
  });

  it('says where the source does not compile, and shows it', async () => {
    const source = readFileSync(sourceFile, 'utf8');
    writeFileSync(sourceFile, source.replace('return instance;', 'return instanse;'));
    await build('open it').click();
    await offer().getByText(/The build of my_wave failed: my_wave\.cpp, line \d+: .*instanse/).waitFor();
    await offer().getByRole('button', { name: 'Show the source' }).click();
    await page().getByRole('textbox', { name: 'Source of my_wave' }).getByText('instanse').waitFor();
    writeFileSync(sourceFile, source);
  });

  it('is built, loaded and opened by one click', async () => {
    await build('open it').click();
    assert.ok(await waitUntil(async () => (await page().getByTestId('draft-file').count()) === 1));
    assert.equal(await page().getByTestId('draft-file').textContent(), 'robot.simulation.xml');
    assert.equal(await offer().count(), 0);
    await page().getByRole('button', { name: 'Simulate', exact: true }).click();
    await isShown('Live');
    await page().getByText('steepness').first().waitFor();
  });

  it('has a command line that gives the same run', async () => {
    assert.ok(await waitUntil(async () => Number(await page().getByTestId('tick').textContent()) > 20)); // it runs already
    await page().keyboard.press('k');
    await viewer.waitForState('paused');
    const command = await shownCommand(viewer);
    assert.ok(command.includes(` --algorithms ${library}`), command);
    await page().keyboard.press('x');
    const hash = await page().getByTestId('setpoint-hash').textContent();
    await page().keyboard.press('x');
    assert.equal(resultOf(command)['setpoint_hash'], hash);
  });

  it('is started again after a crash, with the scenario: it is built, and runs on the page Live', async () => {
    await page().keyboard.press('3');
    await page().getByRole('tab', { name: 'Run', exact: true }).click();
    const duration = page().getByRole('region', { name: 'Run', exact: true }).getByRole('textbox', { name: 'duration' });
    await duration.fill('12');
    await duration.press('Enter');
    assert.ok(await waitUntil(() => existsSync(journal)));
    viewer.expected.push(lostConnection);
    await ui.kill();
    await viewer.close();
    await start([scenario, '--paused', '--recordings', folder]);
    await isShown('Make');
    await offer().getByText('needs the algorithm my_wave, which is not loaded.').waitFor();
    await build('open it').click();
    await isShown('Live');
    await page().getByText('steepness').first().waitFor();
    await page().keyboard.press('3');
    await page().getByTestId('unsaved').getByRole('button', { name: 'Restore' }).click();
    assert.ok(await waitUntil(async () => (await page().getByTestId('draft-state').textContent()) === '1 file changed'));
  });
});
