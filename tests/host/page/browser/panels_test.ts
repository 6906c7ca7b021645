// Each panel and dialog, light and dark, in a wide and in a narrow window: nothing is cut, and axe-core finds no serious problem.
import assert from 'node:assert/strict';
import { cpSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { after, before, beforeEach, describe, it } from 'node:test';
import { seriousProblems } from './support/accessibility.js';
import { assertNothingIsCut } from './support/layout.js';
import { record } from './support/recorded.js';
import { moduleOf, ScriptedRobot } from './support/scripted_robot.js';
import { useUi } from './support/ui_fixture.js';
import { UiProgram, uniform } from './support/ui_program.js';
import type { Look, Viewer } from './support/viewer.js';

const looks: readonly Look[] = [
  { name: 'wide_light', width: 1400, colours: 'light' },
  { name: 'wide_dark', width: 1400, colours: 'dark' },
  { name: 'narrow_light', width: 360, colours: 'light' },
  { name: 'narrow_dark', width: 360, colours: 'dark' },
];

async function assertLooks(viewer: Viewer, name: string): Promise<void> {
  for (const look of looks) {
    await viewer.lookAs(look);
    await assertNothingIsCut(viewer);
    assert.deepEqual(await seriousProblems(viewer), [], look.name);
    await viewer.screenshot(`panel_${name}_${look.name}`);
  }
}

describe('the page of a simulation', () => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-panels-'));
  const ui = useUi(
    () => {
      cpSync(dirname(uniform), folder, { recursive: true });
      const stick = { device: 'A pad', element: 'ABS_X', parameters: ['amplitude'], method: 'linear', lower: 10, upper: 50, step: 1 };
      const button = { device: 'A pad', element: 'BTN_EAST', action: 'stop' };
      writeFileSync(join(folder, 'uniform.remote.json'), JSON.stringify({ version: 1, bindings: [stick, button] }));
      writeFileSync(join(folder, 'broken.proleg'), 'no recording');
      record(join(folder, 'run.proleg'), uniform, '--seconds', '5', '--set', 'amplitude=30@200');
      return UiProgram.start(join(folder, 'uniform.simulation.xml'), ['--recordings', folder]);
    },
    { takesControl: true },
  );

  after(() => rmSync(folder, { recursive: true }));

  before(async () => {
    await ui.viewer.run();
    await ui.viewer.waitForTick(60);
    await ui.viewer.pause();
    const field = ui.viewer.parameter('1.amplitude').getByRole('textbox');
    await field.fill('30');
    await field.press('Enter');
    await ui.viewer.button('Run').focus();
  });

  it('has a form to move the robot', async () => {
    await ui.viewer.button('Move').click();
    await ui.viewer.page.getByRole('form', { name: 'Place of the head' }).waitFor();
    await assertLooks(ui.viewer, 'move');
    await ui.viewer.button('Move').click();
  });

  it('has bindings of remote controls', async () => {
    await ui.viewer.page.locator('.remote-panel summary').click();
    await ui.viewer.page.getByTestId('bindings').waitFor();
    await assertLooks(ui.viewer, 'remote');
    await ui.viewer.page.locator('.remote-panel summary').click();
  });

  for (const [title, name, button, testId] of [
    ['a table of all values', 'values', 'Table…', 'value-table'],
    ['a list of what the file lacks', 'diff', 'Apply to file…', 'diff'],
  ] as const) {
    it(`has ${title}`, async () => {
      await ui.viewer.button(button).click();
      await ui.viewer.page.getByTestId(testId).waitFor();
      await assertLooks(ui.viewer, name);
      await ui.viewer.button('Close').click();
    });
  }

  it('has a list of recordings, and shows one', async () => {
    const { viewer } = ui;
    await viewer.page.getByRole('navigation').getByRole('button', { name: 'Recordings' }).click();
    const row = (name: string) => viewer.page.getByTestId('recordings').locator('tr').filter({ hasText: name });
    await row('run.proleg').getByText('5.00 s').waitFor();
    await row('broken.proleg').getByText(/expected a recording/).waitFor();
    await assertLooks(viewer, 'recordings');
    await viewer.button('run.proleg').click();
    await viewer.page.getByTestId('opened').waitFor();
    await viewer.page.locator('.recorded [data-testid=joints] tbody tr').first().waitFor();
    await assertLooks(viewer, 'recording');
  });
});

describe('the page of a robot on a bus', () => {
  const ui = useUi(() => ScriptedRobot.start());

  beforeEach(async () => {
    ui.program.reset();
    await ui.viewer.takeControl();
  });

  for (const [state, text] of [
    ['off', 'power off'],
    ['starting', 'starting'],
    ['held', 'holding'],
    ['running', 'gait'],
    ['stopping', 'stopping'],
  ] as const) {
    it(`is ${text}`, async () => {
      ui.program.session.state = state;
      ui.program.publish();
      await ui.viewer.waitForState(text);
      await assertLooks(ui.viewer, `robot_${state}`);
    });
  }

  it('has faults, a current near its limit and one above it, and foreign nodes', async () => {
    const [, second, third, fourth] = ui.program.bus.modules;
    Object.assign(second as object, { fault: 'over-current', advice: 'Look whether the joint is blocked; give it less amplitude.', current: 2400 });
    Object.assign(third as object, { silent: true, stop_confirmed: false });
    Object.assign(fourth as object, { current: 1800 });
    ui.program.bus.modules.push(moduleOf(17, null));
    Object.assign(ui.program.bus, { address: 'sim:scenarios/travelling_wave/uniform.simulation.xml', other_host: true, problem: 'The adapter reports errors on the bus.' });
    Object.assign(ui.program.session, { state: 'off', stopped_by: 'desk', failure: 'a module has not confirmed its new mode' });
    ui.program.publish();
    await ui.viewer.page.getByTestId('troubles').waitFor();
    await ui.viewer.page.locator('tr[data-node="2"]').getByText('2400 above limit').waitFor();
    await ui.viewer.page.locator('tr[data-node="4"]').getByText('1800 near limit').waitFor();
    await assertLooks(ui.viewer, 'robot_faults');
  });

  it('is without its bus', async () => {
    Object.assign(ui.program.bus, { connected: false, problem: 'can0 is down: ip link set can0 up.', modules: [] });
    ui.program.publish();
    await ui.viewer.page.getByTestId('bus-band').waitFor();
    await assertLooks(ui.viewer, 'robot_lost');
  });
});
