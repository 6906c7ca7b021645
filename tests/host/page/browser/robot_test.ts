// A robot on a simulated bus: power, positions, gait, STOP, and what happens when nobody drives.
import assert from 'node:assert/strict';
import { afterEach, beforeEach, describe, it } from 'node:test';
import { useUi } from './support/ui_fixture.js';
import { UiProgram } from './support/ui_program.js';
import type { Viewer } from './support/viewer.js';

describe('a robot on a bus', () => {
  const ui = useUi(() => UiProgram.startOnBus());

  beforeEach(() => ui.viewer.takeControl());

  afterEach(async () => {
    if (!(await ui.viewer.page.getByText('power off', { exact: true }).isVisible())) await ui.viewer.page.keyboard.press('Escape');
    await ui.viewer.waitForState('power off');
  });

  async function powerOn(): Promise<void> {
    await ui.viewer.button('Power on').click();
    await ui.viewer.waitForState('holding');
  }

  async function runGait(): Promise<void> {
    await ui.viewer.button('Run gait').click();
    await ui.viewer.waitForState('gait');
  }

  // Waits until the joint has measured an angle within two degrees of this one: the servo of the simulation is not stiff.
  async function waitForAngle(joint: string, angle: number): Promise<void> {
    await ui.viewer.page.waitForFunction(
      ([name, wanted]) => {
        const rows = [...document.querySelectorAll('[data-testid=joints] tbody tr')];
        const cell = rows.find((row) => row.querySelector('th')?.textContent === name)?.querySelector('td[data-value=angle]');
        return Math.abs(Number(cell?.textContent) - wanted) < 2;
      },
      [joint, angle] as const,
    );
  }

  async function assertStopped(other: Viewer = ui.viewer): Promise<void> {
    await other.waitForState('power off');
    assert.match(await other.stopReport(), /^stopped in \d+ ms, 5 of 5 confirmed$/);
  }

  it('has no power at first; its modules are in the table', async () => {
    await ui.viewer.page.getByText(/^ROBOT sim:/).waitFor();
    await ui.viewer.waitForState('power off');
    for (const node of [1, 2, 3, 4, 5]) {
      await ui.viewer.page.locator(`tr[data-node="${node}"]`).waitFor();
    }
  });

  it('runs the gait, whose state frames are those of this computer, holds, and runs on', async () => {
    await runGait();
    const angles = await ui.viewer.angles();
    await ui.viewer.waitForOtherAngles(angles);
    await ui.viewer.page.getByTestId('gait').getByText(/^[1-9][\d,]* compared, 0 differences/).waitFor();
    await ui.viewer.waitForTick(300);
    await ui.viewer.screenshot('robot_gait');
    await ui.viewer.button('Hold').click();
    await ui.viewer.waitForState('holding');
    await runGait();
  });

  it('holds with power, goes where a slider says, and back to 0', async () => {
    await powerOn();
    await ui.viewer.page.getByRole('slider', { name: 'Position of J2', exact: true }).fill('30');
    await waitForAngle('J2', 30);
    await waitForAngle('J1', 0);
    const field = ui.viewer.page.getByLabel('Position of J4 in degrees');
    await field.fill('-25');
    await field.press('Enter');
    await waitForAngle('J4', -25);
    await waitForAngle('J2', 30);
    await ui.viewer.screenshot('robot_posed');
    await ui.viewer.button('All to 0').click();
    for (const joint of ['J1', 'J2', 'J3', 'J4', 'J5']) {
      await waitForAngle(joint, 0);
    }
    await ui.viewer.button('Power off').click();
    await ui.viewer.waitForState('power off');
  });

  it('confirms a parameter that changes while the gait runs', async () => {
    await runGait();
    const field = ui.viewer.parameter('1.amplitude').getByRole('textbox');
    await field.fill('25');
    await field.press('Enter');
    const cells = ui.viewer.parameter('1.amplitude').locator('[data-cell][title*="wanted 25, confirmed 25"]');
    await cells.nth(4).waitFor();
  });

  it('stops while it holds', async () => {
    await powerOn();
    await ui.viewer.button(/^STOP/).click();
    await assertStopped();
  });

  it('stops in the gait, by Esc, and can be given power again', async () => {
    await runGait();
    await ui.viewer.page.keyboard.press('Escape');
    await assertStopped();
    await powerOn();
  });

  it('stops while it starts', async () => {
    await ui.viewer.button('Run gait').click();
    // STOP has a connection of its own, so it could come before the request that it stops.
    await ui.viewer.page.getByTestId('state').getByText('power off', { exact: true }).waitFor({ state: 'detached' });
    await ui.viewer.page.keyboard.press('Escape');
    await assertStopped();
  });

  it('says of a robot without power that it is stopped', async () => {
    await ui.viewer.page.keyboard.press('Escape');
    await assertStopped();
  });

  // A viewer who drives instead of the one that all tests have.
  async function otherDriver(): Promise<Viewer> {
    const other = await ui.look();
    await ui.viewer.button('Release').click();
    await other.takeControl();
    return other;
  }

  it('stops when the page of its driver has gone, and says why', async () => {
    const driver = await otherDriver();
    await driver.button('Run gait').click();
    await ui.viewer.waitForState('gait');
    await driver.page.goto('about:blank');
    await ui.viewer.waitForState('power off');
    await ui.viewer.page.getByTestId('robot-hint').filter({ hasText: /nobody drives|look on/ }).waitFor();
    assert.match((await ui.viewer.page.getByTestId('state').getAttribute('title')) ?? '', /nobody drives/);
  });

  it('stops when the page of its driver hangs', async () => {
    const driver = await otherDriver();
    await driver.button('Power on').click();
    await ui.viewer.waitForState('holding');
    const goOn = await driver.hang();
    await ui.viewer.waitForState('power off');
    await goOn();
  });

  it('is shown to two viewers; either may stop it, one drives', async () => {
    const other = await ui.look();
    await runGait();
    await other.waitForState('gait');
    assert.equal(await other.button('Hold').isDisabled(), true);
    await other.button(/^STOP/).click();
    await assertStopped(other);
    await ui.viewer.waitForState('power off');
  });

  it('holds on while control passes to another viewer', async () => {
    const other = await ui.look();
    await powerOn();
    await other.button('Ask for control').click();
    await ui.viewer.button('Give control').click();
    await other.button('Release').waitFor();
    await other.waitForState('holding');
    await other.button('Power off').click();
    await ui.viewer.waitForState('power off');
  });

  it('can be driven with the keyboard alone', async () => {
    const { keyboard } = ui.viewer.page;
    await keyboard.press('o');
    await ui.viewer.waitForState('holding');
    const slider = ui.viewer.page.getByRole('slider', { name: 'Position of J1', exact: true });
    await slider.focus();
    await keyboard.press('PageUp');
    const before = await slider.inputValue();
    await keyboard.press('PageUp');
    await ui.viewer.page.waitForFunction((value) => Number((document.activeElement as HTMLInputElement).value) > Number(value), before);
    await ui.viewer.page.getByTestId('scene').focus();
    await keyboard.press('k');
    await ui.viewer.waitForState('gait');
    await keyboard.press('k');
    await ui.viewer.waitForState('holding');
    await keyboard.press('Shift+O');
    await ui.viewer.waitForState('power off');
    await keyboard.press('o');
    await ui.viewer.waitForState('holding');
    await keyboard.press('Space');
    await assertStopped();
  });
});
