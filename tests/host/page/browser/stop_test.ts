// STOP, from every state and over both ways.
import assert from 'node:assert/strict';
import { after, afterEach, before, beforeEach, describe, it } from 'node:test';
import type { Browser } from 'playwright-core';
import { launchBrowser } from './support/browser.js';
import { UiProgram } from './support/ui_program.js';
import { Viewer } from './support/viewer.js';

describe('STOP', () => {
  let browser: Browser;
  let program: UiProgram;
  let viewer: Viewer;

  before(async () => {
    browser = await launchBrowser();
  });

  after(async () => {
    await browser.close();
  });

  beforeEach(async () => {
    program = await UiProgram.start();
    viewer = await Viewer.open(browser, program.address);
    await viewer.takeControl();
  });

  afterEach(async () => {
    await viewer.close();
    await program.end();
  });

  async function assertStopped(): Promise<void> {
    await viewer.waitForState('STOPPED');
    assert.match(await viewer.stopReport(), /^stopped in \d+ ms, 5 of 5 confirmed$/);
  }

  it('works by a press of its button while the robot runs; the holder may run on', async () => {
    await viewer.run();
    await viewer.waitForTick(30);
    await viewer.button(/^STOP/).click();
    await assertStopped();
    await viewer.screenshot('stopped');
    const tick = await viewer.tick();
    await viewer.run();
    await viewer.waitForTick(tick + 20);
  });

  it('works by Esc, in a text field too', async () => {
    await viewer.run();
    await viewer.parameter('1.amplitude').getByRole('textbox').focus();
    await viewer.page.keyboard.press('Escape');
    await assertStopped();
  });

  it('works by Space outside text fields, also when a button has the focus', async () => {
    await viewer.run();
    await viewer.button('Release').focus();
    await viewer.page.keyboard.press('Space');
    await assertStopped();
    await viewer.button('Release').waitFor();
  });

  it('does not work by Space in a text field, where it is a space', async () => {
    await viewer.run();
    await viewer.page.keyboard.press('Control+k');
    await viewer.page.getByRole('combobox', { name: 'Name of the action' }).pressSequentially('run or');
    await viewer.waitForState('running');
    await viewer.button(/^STOP/).click();
    await assertStopped();
  });

  it('works while the robot is paused', async () => {
    await viewer.page.keyboard.press('Escape');
    await assertStopped();
  });

  it('says that it does not replace a power switch', async () => {
    await viewer.page.getByText('does not replace a power switch', { exact: true }).waitFor();
    assert.match((await viewer.button(/^STOP/).getAttribute('title')) ?? '', /does not replace a power switch/);
  });

  it('reaches a robot whose holder hangs: from another viewer', async () => {
    const other = await Viewer.open(browser, program.address);
    await viewer.run();
    await viewer.block(4000);
    await other.page.getByTestId('control').filter({ hasText: 'is away' }).waitFor();
    await other.page.keyboard.press('Escape');
    await other.waitForState('STOPPED');
    assert.match(await other.stopReport(), /5 of 5 confirmed/);
    await viewer.waitForState('STOPPED');
    await other.close();
  });

  it('is kept while the page hangs, and takes effect when it goes on', async () => {
    await viewer.run();
    await viewer.block(1500);
    await viewer.page.keyboard.press('Escape');
    await assertStopped();
  });

  it('goes by POST if its socket is stuck', async () => {
    // Takes what the page sends on the socket of STOP, and never answers. Sockets of workers are not affected.
    await viewer.page.routeWebSocket(/\/socket$/, () => {});
    await viewer.page.reload();
    await viewer.takeControl();
    await viewer.run();
    await viewer.page.keyboard.press('Escape');
    await viewer.waitForState('STOPPED');
    assert.match(await viewer.stopReport(), /^stopped in \d+ ms$/);
  });
});
