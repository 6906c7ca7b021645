// A robot on a simulated bus: power, positions, gait, STOP, and what happens when nobody drives.
import assert from 'node:assert/strict';
import { after, afterEach, before, beforeEach, describe, it } from 'node:test';
import type { Browser } from 'playwright-core';
import { launchBrowser } from './support/browser.js';
import { UiProgram } from './support/ui_program.js';
import { Viewer } from './support/viewer.js';

describe('a robot on a bus', () => {
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
    program = await UiProgram.startOnBus();
    viewer = await Viewer.open(browser, program.address);
    await viewer.takeControl();
  });

  afterEach(async () => {
    await program.end();
    await viewer.close([/WebSocket connection .* failed/]);
  });

  async function powerOn(): Promise<void> {
    await viewer.button('Power on').click();
    await viewer.waitForState('holding');
  }

  async function runGait(): Promise<void> {
    await viewer.button('Run gait').click();
    await viewer.waitForState('gait');
  }

  // Waits until the joint has measured an angle within two degrees of this one: the servo of the simulation is not stiff.
  async function waitForAngle(joint: string, angle: number): Promise<void> {
    await viewer.page.waitForFunction(
      ([name, wanted]) => {
        const rows = [...document.querySelectorAll('[data-testid=joints] tbody tr')];
        const cell = rows.find((row) => row.querySelector('th')?.textContent === name)?.querySelector('td[data-value=angle]');
        return Math.abs(Number(cell?.textContent) - wanted) < 2;
      },
      [joint, angle] as const,
    );
  }

  async function assertStopped(other: Viewer = viewer): Promise<void> {
    await other.waitForState('power off');
    assert.match(await other.stopReport(), /^stopped in \d+ ms, 5 of 5 confirmed$/);
  }

  it('has no power at first; its modules are in the table', async () => {
    await viewer.page.getByText(/^ROBOT sim:/).waitFor();
    await viewer.waitForState('power off');
    for (const node of [1, 2, 3, 4, 5]) {
      await viewer.page.locator(`tr[data-node="${node}"]`).waitFor();
    }
  });

  it('holds with power, goes where a slider says, and back to 0', async () => {
    await powerOn();
    await viewer.page.getByRole('slider', { name: 'Position of J2', exact: true }).fill('30');
    await waitForAngle('J2', 30);
    await waitForAngle('J1', 0);
    const field = viewer.page.getByLabel('Position of J4 in degrees');
    await field.fill('-25');
    await field.press('Enter');
    await waitForAngle('J4', -25);
    await waitForAngle('J2', 30);
    await viewer.screenshot('robot_posed');
    await viewer.button('All to 0').click();
    for (const joint of ['J1', 'J2', 'J3', 'J4', 'J5']) {
      await waitForAngle(joint, 0);
    }
    await viewer.button('Power off').click();
    await viewer.waitForState('power off');
  });

  it('runs the gait, whose state frames are those of this computer, holds, and runs on', async () => {
    await runGait();
    const angles = await viewer.angles();
    await viewer.waitForOtherAngles(angles);
    await viewer.page.getByTestId('gait').getByText(/^[1-9][\d,]* compared, 0 differences/).waitFor();
    await viewer.waitForTick(300);
    await viewer.screenshot('robot_gait');
    await viewer.button('Hold').click();
    await viewer.waitForState('holding');
    await runGait();
  });

  it('confirms a parameter that changes while the gait runs', async () => {
    await runGait();
    const field = viewer.parameter('1.amplitude').getByRole('textbox');
    await field.fill('25');
    await field.press('Enter');
    const cells = viewer.parameter('1.amplitude').locator('[data-cell][title*="wanted 25, confirmed 25"]');
    await cells.nth(4).waitFor();
  });

  it('stops while it holds', async () => {
    await powerOn();
    await viewer.button(/^STOP/).click();
    await assertStopped();
  });

  it('stops in the gait, by Esc, and can be given power again', async () => {
    await runGait();
    await viewer.page.keyboard.press('Escape');
    await assertStopped();
    await powerOn();
  });

  it('stops while it starts', async () => {
    await viewer.button('Run gait').click();
    await viewer.page.keyboard.press('Escape');
    await assertStopped();
  });

  it('says of a robot without power that it is stopped', async () => {
    await viewer.page.keyboard.press('Escape');
    await assertStopped();
  });

  it('stops when the page of its driver has gone, and says why', async () => {
    const other = await Viewer.open(browser, program.address);
    await runGait();
    await viewer.page.goto('about:blank');
    await other.waitForState('power off');
    await other.page.getByTestId('robot-hint').filter({ hasText: /nobody drives|look on/ }).waitFor();
    assert.match((await other.page.getByTestId('state').getAttribute('title')) ?? '', /nobody drives/);
    await other.close();
  });

  it('stops when the page of its driver hangs', async () => {
    const other = await Viewer.open(browser, program.address);
    await powerOn();
    await viewer.block(6000);
    await other.waitForState('power off');
    await other.close();
  });

  it('is shown to two viewers; either may stop it, one drives', async () => {
    const other = await Viewer.open(browser, program.address);
    await runGait();
    await other.waitForState('gait');
    assert.equal(await other.button('Hold').isDisabled(), true);
    await other.button(/^STOP/).click();
    await assertStopped(other);
    await viewer.waitForState('power off');
    await other.close();
  });

  it('holds on while control passes to another viewer', async () => {
    const other = await Viewer.open(browser, program.address);
    await powerOn();
    await other.button('Ask for control').click();
    await viewer.button('Give control').click();
    await other.button('Release').waitFor();
    await other.waitForState('holding');
    await other.button('Power off').click();
    await viewer.waitForState('power off');
    await other.close();
  });

  it('can be driven with the keyboard alone', async () => {
    const { keyboard } = viewer.page;
    await keyboard.press('o');
    await viewer.waitForState('holding');
    const slider = viewer.page.getByRole('slider', { name: 'Position of J1', exact: true });
    await slider.focus();
    await keyboard.press('PageUp');
    const before = await slider.inputValue();
    await keyboard.press('PageUp');
    await viewer.page.waitForFunction((value) => Number((document.activeElement as HTMLInputElement).value) > Number(value), before);
    await viewer.page.getByTestId('scene').focus();
    await keyboard.press('k');
    await viewer.waitForState('gait');
    await keyboard.press('k');
    await viewer.waitForState('holding');
    await keyboard.press('Shift+O');
    await viewer.waitForState('power off');
  });
});
