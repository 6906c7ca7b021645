// What the page shows of a robot on a bus, and what it sends: against a script, which can break what a simulated bus cannot.
import assert from 'node:assert/strict';
import { beforeEach, describe, it } from 'node:test';
import { seriousProblems } from './support/accessibility.js';
import { assertNothingIsCut } from './support/layout.js';
import { countPixelsWhen } from './support/pixels.js';
import { moduleOf, ScriptedRobot } from './support/scripted_robot.js';
import { useUi } from './support/ui_fixture.js';
import type { Look } from './support/viewer.js';
import { waitForFrames, waitUntil } from './support/waiting.js';

const isGhost = (red: number, green: number, blue: number) => green > red + 20 && green > blue;

const looks: readonly Look[] = [
  { name: 'narrow_light', width: 360, colours: 'light' },
  { name: 'narrow_dark', width: 360, colours: 'dark' },
  { name: 'wide_dark', width: 1400, colours: 'dark' },
];

describe('the page of a robot on a bus', () => {
  const ui = useUi(() => ScriptedRobot.start());

  beforeEach(() => ui.program.reset());

  const slider = (joint: number) => ui.viewer.page.locator(`[data-pose="${joint}"]`).getByRole('slider');
  const cell = (joint: number, column: string) =>
    ui.viewer.page.locator(`[data-testid=joints] tr[data-joint="${joint}"] td[data-value="${column}"]`);

  // Waits until the robot was sent to the angles that fulfil the condition.
  async function waitForPose(matches: (angles: (number | null)[]) => boolean): Promise<void> {
    const isThere = await waitUntil(() => ui.program.poses.some(({ angles }) => matches(angles)));
    assert.ok(isThere, `found ${JSON.stringify(ui.program.poses.at(-1))}`);
  }

  it('names the bus beside the badge, and shows its load', async () => {
    await ui.viewer.page.getByText('ROBOT can0', { exact: true }).waitFor();
    await ui.viewer.page.getByTestId('load').getByText('11.8 %').waitFor();
    await ui.viewer.waitForState('holding');
  });

  it('disables what needs control, and says so', async () => {
    assert.equal(await ui.viewer.button('Run gait').isDisabled(), true);
    assert.match((await ui.viewer.button('Run gait').getAttribute('title')) ?? '', /Take control first/);
    assert.equal(await slider(0).isDisabled(), true);
  });

  it('disables what the state does not allow, and says why', async () => {
    await ui.viewer.takeControl();
    assert.match((await ui.viewer.button('Power on').getAttribute('title')) ?? '', /Power off first/);
    await ui.viewer.button('Run gait').click();
    await ui.viewer.waitForState('gait');
    await ui.viewer.page.getByTestId('pose-hint').getByText('Hold first.').waitFor();
    assert.equal(await slider(0).isDisabled(), true);
  });

  it('sends a joint to the angle of its slider, and the others nowhere', async () => {
    await ui.viewer.takeControl();
    await slider(1).fill('30');
    await waitForPose((angles) => JSON.stringify(angles) === '[null,30,null,null,null]');
    await cell(1, 'set-point').getByText('30.0').waitFor();
    await ui.viewer.screenshot('robot_held');
  });

  it('sends at most 50 messages a second while a slider is dragged, and the last angle', async () => {
    await ui.viewer.takeControl();
    await slider(0).evaluate((element: HTMLInputElement) => {
      for (let angle = 0; angle <= 60; angle += 0.5) {
        element.value = String(angle);
        element.dispatchEvent(new Event('input', { bubbles: true }));
      }
    });
    await waitForPose((angles) => angles[0] === 60);
    assert.ok(ui.program.poses.length <= 3, `found ${ui.program.poses.length} messages for one burst`);
  });

  it('takes a typed angle, and rejects one beyond the limits of the joint', async () => {
    await ui.viewer.takeControl();
    const field = ui.viewer.page.getByLabel('Position of J3 in degrees');
    await field.fill('120');
    await field.press('Enter');
    await ui.viewer.page.getByText('J3: found 120, expected -90 to 90 degrees').waitFor();
    assert.equal(ui.program.poses.length, 0);
    await field.fill('-45.5');
    await field.press('Enter');
    await waitForPose((angles) => angles[2] === -45.5);
  });

  it('sends all joints to 0', async () => {
    await ui.viewer.takeControl();
    await ui.viewer.page.getByLabel('Speed').fill('20');
    await ui.viewer.button('All to 0').click();
    await waitForPose((angles) => angles.every((angle) => angle === 0));
    assert.equal(ui.program.poses.at(-1)?.speed, 20);
  });

  it('turns the joint whose link is dragged in the 3D view', async () => {
    await ui.viewer.takeControl();
    const box = (await ui.viewer.page.locator('.scene').boundingBox()) as { x: number; y: number; width: number; height: number };
    const { mouse } = ui.viewer.page;
    // Finds the robot: a joint is lit where the pointer is on it.
    const lit = ui.viewer.page.locator('[data-pose].hovered');
    const y = box.y + box.height / 2;
    // On a busy computer the light comes some frames later: it must be that of this position.
    const isLitAt = async (x: number) => {
      await mouse.move(x, y);
      await waitForFrames(ui.viewer.page, 20);
      return (await lit.count()) > 0;
    };
    let x = box.x + box.width * 0.3;
    while (!(await isLitAt(x)) && x < box.x + box.width * 0.7) {
      x += 12;
    }
    await mouse.down();
    // The view follows the pointer as soon as it has found the joint, which takes longer on a busy computer.
    let height = 15;
    const isTurned = async () => {
      height = 55 - height;
      await mouse.move(x, y - height, { steps: 5 });
      return ui.program.poses.some(({ angles }) => angles.some((angle) => angle !== null && Math.abs(angle) > 3));
    };
    assert.ok(await waitUntil(isTurned));
    assert.equal(ui.program.poses.at(-1)?.angles.filter((angle) => angle !== null).length, 1);
    await ui.viewer.screenshot('robot_pulled');
    await mouse.up();
  });

  it('shows the simulation as a ghost, until it is switched off', async () => {
    const { page } = ui.viewer;
    const waitForGhost = async (isThere: boolean) => {
      const count = await countPixelsWhen(page, page.locator('.scene'), isGhost, (pixels) => pixels > 500 === isThere);
      assert.equal(count > 500, isThere, `found ${count} pixels of the ghost`);
    };
    await waitForGhost(true);
    await page.keyboard.press('Shift+G');
    await waitForGhost(false);
  });

  it('says which joints do not measure their angle', async () => {
    ui.program.unmeasured = 2;
    await cell(2, 'angle').getByText('not measured').waitFor();
    await cell(1, 'angle').getByText('-2.0').waitFor();
  });

  it('shows faults with what to do, silent nodes, and those of no joint', async () => {
    Object.assign(ui.program.bus.modules[1] as object, { fault: 'over-current', advice: 'Free the joint, then clear the fault with “proleg bus”.' });
    Object.assign(ui.program.bus.modules[3] as object, { silent: true });
    ui.program.bus.modules.push(moduleOf(17, null));
    ui.program.bus.other_host = true;
    ui.program.publish();
    await ui.viewer.page.getByTestId('troubles').getByText('Free the joint').waitFor();
    await ui.viewer.page.getByTestId('troubles').getByText('J4: silent').waitFor();
    await cell(1, 'module').getByText('over-current').waitFor();
    await ui.viewer.page.locator('tr[data-node="17"]').getByText('not of this robot').waitFor();
    await ui.viewer.page.getByText('Another host drives modules on can0').waitFor();
    assert.deepEqual(await seriousProblems(ui.viewer), []);
    await ui.viewer.screenshot('robot_faults');
  });

  it('compares with the gait, and shows the first difference', async () => {
    const verdict = ui.viewer.page.getByTestId('gait');
    await verdict.getByText('5,000 compared, 0 differences, 2 missing').waitFor();
    assert.match((await verdict.getAttribute('class')) ?? '', /good/);
    Object.assign(ui.program.session.gait as object, { differences: 1, first_difference: 'J2, tick 812: found 1, expected 2' });
    ui.program.publish();
    await ui.viewer.page.getByText('J2, tick 812').waitFor();
    assert.match((await verdict.getAttribute('class')) ?? '', /bad/);
  });

  it('is red about modules that have not confirmed STOP', async () => {
    Object.assign(ui.program.bus.modules[2] as object, { stop_confirmed: false });
    ui.program.stopAnswer = { confirmed: 4, of: 5 };
    await ui.viewer.page.keyboard.press('Escape');
    assert.match(await ui.viewer.stopReport(), /4 of 5 confirmed\. Use the power switch/);
    await ui.viewer.page.getByTestId('unconfirmed-band').getByText('not confirmed by J3').waitFor();
    assert.match((await cell(2, 'module').getAttribute('class')) ?? '', /bad/);
    await ui.viewer.screenshot('robot_unconfirmed');
  });

  it('says that the bus is lost, and greys what it showed of it', async () => {
    Object.assign(ui.program.bus, { connected: false, problem: 'can0 is down: ip link set can0 up.' });
    ui.program.publish();
    await ui.viewer.page.getByTestId('bus-band').getByText('can0 is down').waitFor();
    await ui.viewer.page.getByTestId('age-band').getByText(/Last heard \d+ s ago/).waitFor();
    await ui.viewer.page.locator('.live.old').waitFor();
    await ui.viewer.screenshot('robot_lost_bus');
  });

  it('greys what is older than 2 s while the program is silent, and comes back', async () => {
    // The bus that the test before lost comes back with the next message.
    await ui.viewer.page.locator('.live.old').waitFor({ state: 'detached' });
    ui.program.isSilent = true;
    await ui.viewer.page.locator('.live.old').waitFor();
    await ui.viewer.page.getByTestId('age-band').waitFor();
    ui.program.isSilent = false;
    await ui.viewer.page.locator('.live.old').waitFor({ state: 'detached' });
  });

  it('has no actions of a simulation in its palette', async () => {
    await ui.viewer.page.keyboard.press('Control+k');
    const list = ui.viewer.page.getByRole('listbox', { name: 'Actions' });
    await list.getByText('Power on: joints hold').waitFor();
    assert.equal(await list.getByText('Restart').count(), 0);
    assert.equal(await list.getByText('Swap the sets').count(), 0);
    await ui.viewer.button('Close').click();
  });

  for (const look of looks) {
    it(`fits the window, without a serious problem for axe-core (${look.name})`, async () => {
      const { viewer } = ui;
      await viewer.lookAs(look);
      await viewer.takeControl();
      await viewer.waitForTick(20);
      await assertNothingIsCut(viewer);
      assert.deepEqual(await seriousProblems(viewer), []);
      await viewer.screenshot(`robot_${look.name}`);
    });
  }
});
