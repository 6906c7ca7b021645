// A session of clicks is a run like any other: its recording replays without a difference, and the command that the
// page shows gives the same hashes.
import assert from 'node:assert/strict';
import { mkdtempSync, readdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, describe, it } from 'node:test';
import { resultOf, shownCommand } from './support/command_line.js';
import { useUi } from './support/ui_fixture.js';
import { UiProgram, uniform } from './support/ui_program.js';
import type { Viewer } from './support/viewer.js';

async function clickAround(viewer: Viewer): Promise<string> {
  await viewer.takeControl();
  await viewer.run();
  const amplitude = viewer.parameter('1.amplitude').getByRole('slider').first();
  await amplitude.focus();
  for (let press = 0; press < 5; press += 1) {
    await viewer.page.keyboard.press('ArrowLeft');
  }
  await viewer.waitForConfirmation('1.amplitude');
  // Not from the start: the recording has what was before, too.
  await viewer.button('Record').click();
  await viewer.button('Recording').waitFor();
  await viewer.parameter('1.phase_difference').locator('[data-cell="2"]').focus();
  await viewer.page.keyboard.press('ArrowUp');
  await viewer.waitForConfirmation('1.phase_difference');
  await viewer.page.keyboard.press('Control+z');
  await viewer.page.keyboard.press('b');
  await viewer.waitForTick((await viewer.tick()) + 100);
  await viewer.pause();
  const command = await shownCommand(viewer);
  await viewer.button('Recording').click();
  await viewer.button('Record').waitFor();
  return command;
}

describe('a session of clicks', () => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-page-'));
  const ui = useUi(() => UiProgram.start(uniform, ['--recordings', folder]));

  after(() => rmSync(folder, { recursive: true }));

  it('is recorded, replays without a difference, and is repeated by the command of the page', async () => {
    const command = await clickAround(ui.viewer);
    const files = readdirSync(folder).filter((name) => name.endsWith('.proleg'));
    assert.equal(files.length, 1, files.join());
    assert.match(files[0] as string, /^uniform-\d{8}-\d{6}\.proleg$/);
    const replayed = resultOf(`proleg replay ${join(folder, files[0] as string)}`);
    assert.equal(replayed['differences'], 0);
    assert.equal(replayed['verified'], true);
    const repeated = resultOf(command);
    assert.match(command, /--set 1\.amplitude=\S+@\d+/);
    assert.equal(repeated['setpoint_hash'], replayed['recorded_setpoint_hash']);
    assert.equal(repeated['servo_hash'], replayed['recorded_servo_hash']);
  });
});
