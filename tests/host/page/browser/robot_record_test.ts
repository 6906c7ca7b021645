// A robot on a simulated bus that other programs reach, too: its modules go and come back, and its next run is recorded.
import assert from 'node:assert/strict';
import { spawn, type ChildProcess } from 'node:child_process';
import { mkdtempSync, readdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, describe, it } from 'node:test';
import { resultOf } from './support/command_line.js';
import { useUi } from './support/ui_fixture.js';
import { program, slowTime, UiProgram, uniform } from './support/ui_program.js';

describe('a robot on a bus of its own', () => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-page-'));
  let robot: ChildProcess;

  // Its address for --bus.
  async function startRobot(): Promise<string> {
    robot = spawn(program, ['bus', uniform, '--tcp', '0'], { stdio: ['ignore', 'pipe', 'ignore'], env: { ...process.env, ...slowTime } });
    const { stdout } = robot;
    assert.ok(stdout);
    let output = '';
    for await (const chunk of stdout) {
      output += String(chunk);
      const address = /--bus (tcp:\S+)/.exec(output)?.[1];
      if (address !== undefined) return address;
    }
    throw new Error(`proleg bus: found '${output}', expected an address`);
  }

  const ui = useUi(async () => UiProgram.serve([uniform, '--bus', await startRobot(), '--recordings', folder], slowTime), { takesControl: true });

  after(() => {
    robot.kill('SIGKILL');
    rmSync(folder, { recursive: true });
  });

  const modules = () => ui.viewer.page.locator('tr[data-node]');
  const silent = () => ui.viewer.page.locator('tr[data-node].silent');

  it('has the limit of the current of each module in its table', async () => {
    for (const node of [1, 2, 3, 4, 5]) {
      await ui.viewer.page.locator(`tr[data-node="${node}"] [data-value=limit]`).getByText('2000', { exact: true }).waitFor();
    }
  });

  it('loses its modules, says so, and finds them again', async () => {
    robot.kill('SIGSTOP');
    await silent().nth(4).waitFor();
    await ui.viewer.page.getByTestId('troubles').getByText('J1: silent').waitFor();
    robot.kill('SIGCONT');
    await silent().first().waitFor({ state: 'detached' });
    await ui.viewer.page.getByTestId('troubles').waitFor({ state: 'detached' });
    await ui.viewer.button('Scan again').click();
    await ui.viewer.page.getByTestId('bus').getByText('no power').nth(4).waitFor();
    assert.equal(await modules().count(), 5);
    assert.equal(await silent().count(), 0);
  });

  it('records the next run until it holds, and the recording is that of the gait', async () => {
    const { keyboard } = ui.viewer.page;
    await keyboard.press('r');
    await ui.viewer.button('Will record').waitFor();
    await ui.viewer.button('Run gait').click();
    await ui.viewer.waitForState('gait');
    await ui.viewer.button('Recording').waitFor();
    await ui.viewer.waitForTick(150);
    await ui.viewer.button('Hold').click();
    await ui.viewer.waitForState('holding');
    await ui.viewer.page.getByText(/the recording is in .*\.proleg/).first().waitFor();
    assert.equal(await ui.viewer.button('Record the next run').isDisabled(), true, 'a run is recorded from its tick 0 on');
    await keyboard.press('Shift+O');
    await ui.viewer.waitForState('power off');
    const files = readdirSync(folder).filter((name) => name.endsWith('.proleg'));
    assert.equal(files.length, 1, files.join());
    const replayed = resultOf(`proleg replay ${join(folder, files[0] as string)}`);
    assert.equal(replayed['differences'], 0);
    assert.equal(replayed['verified'], true);
  });
});
