// Two viewers of one robot; a reload; a program that ends.
import assert from 'node:assert/strict';
import { after, afterEach, before, beforeEach, describe, it } from 'node:test';
import type { Browser } from 'playwright-core';
import { launchBrowser } from './support/browser.js';
import { UiProgram } from './support/ui_program.js';
import { Viewer } from './support/viewer.js';

describe('viewers', () => {
  let browser: Browser;
  let program: UiProgram;
  let first: Viewer;
  let second: Viewer;

  before(async () => {
    browser = await launchBrowser();
  });

  after(async () => {
    await browser.close();
  });

  beforeEach(async () => {
    program = await UiProgram.start();
    first = await Viewer.open(browser, program.address);
    second = await Viewer.open(browser, program.address);
    await first.takeControl();
  });

  afterEach(async () => {
    await program.end();
  });

  async function closeBoth(): Promise<void> {
    await first.close();
    await second.close();
  }

  it('see who has control, and what the holder does', async () => {
    await second.page.getByTestId('control').filter({ hasText: 'has control' }).waitFor();
    await first.run();
    await second.waitForState('running');
    await second.waitForTick(50);
    assert.equal(await second.button('Pause').isDisabled(), true);
    await closeBoth();
  });

  it('hand over: one asks, the other gives', async () => {
    await first.run();
    await second.button('Ask for control').click();
    await first.page.getByText('asks for control').waitFor();
    await first.screenshot('request');
    await first.button('Give control').click();
    await second.button('Release').waitFor();
    await first.button('Release').waitFor({ state: 'detached' });
    assert.equal(await first.button('Pause').isDisabled(), true);
    await first.waitForState('running');
    await second.button('Pause').click();
    await first.waitForState('paused');
    await closeBoth();
  });

  it('may keep control, and who asked reads so', async () => {
    await second.button('Ask for control').click();
    await first.button('Keep control').click();
    await second.page.getByRole('list', { name: 'Notices' }).getByRole('listitem').first().waitFor();
    await first.button('Release').waitFor();
    assert.equal(await second.button('Ask for control').isEnabled(), true);
    await closeBoth();
  });

  it('may take control at once after it was released', async () => {
    await first.button('Release').click();
    await second.takeControl();
    await closeBoth();
  });

  it('look on after a reload, while the robot runs on', async () => {
    await first.run();
    await first.waitForTick(50);
    const tick = await first.tick();
    await first.page.reload();
    await first.waitForState('running');
    await first.waitForTick(tick + 20);
    assert.equal(await first.button('Pause').isDisabled(), true);
    await first.takeControl();
    await first.button('Pause').click();
    await first.waitForState('paused');
    await closeBoth();
  });

  it('read that the program has ended', async () => {
    await first.run();
    await first.waitForTick(50);
    await program.end();
    await first.page.getByTestId('connection-band').filter({ hasText: 'The program has ended' }).waitFor();
    await first.waitForState('state unknown');
    assert.equal((await first.angles()).length, 5, 'what was seen stays');
    await first.screenshot('ended');
    await first.close([/WebSocket connection .* failed/]);
    await second.close([/WebSocket connection .* failed/]);
  });

  it('read that the connection is lost when the program is killed', async () => {
    await program.kill();
    await first.page.getByTestId('connection-band').filter({ hasText: 'No connection to the program' }).waitFor();
    await first.close([/WebSocket connection .* failed/]);
    await second.close([/WebSocket connection .* failed/]);
  });
});

describe('a viewer without the right token', () => {
  it('reads what to do', async () => {
    const browser = await launchBrowser();
    const program = await UiProgram.start();
    const page = await browser.newPage();
    await page.goto(program.address.replace(/#.*/, ''));
    await page.getByText('This address has no token').waitFor();
    await page.goto(program.address.replace(/#.*/, '#wrong'));
    await page.reload();
    await page.getByTestId('connection-band').filter({ hasText: 'does not accept this page' }).waitFor();
    await program.end();
    await browser.close();
  });
});
