// The panel of remote controls, without a device: a gamepad that drives is in tests/lab/gamepad.lab.py.
import assert from 'node:assert/strict';
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { after, describe, it } from 'node:test';
import { useUi } from './support/ui_fixture.js';
import { UiProgram, uniform } from './support/ui_program.js';

const saved = {
  version: 1,
  bindings: [
    { device: 'A pad', element: 'ABS_X', parameters: ['amplitude'], method: 'linear', lower: 10, upper: 50, step: 1 },
    { device: 'A pad', element: 'BTN_EAST', action: 'stop' },
  ],
};

describe('the panel of remote controls', () => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-remote-'));
  const file = join(folder, 'uniform.remote.json');
  const ui = useUi(() => {
    cpSync(dirname(uniform), folder, { recursive: true });
    writeFileSync(file, JSON.stringify(saved));
    return UiProgram.start(join(folder, 'uniform.simulation.xml'));
  });

  after(() => rmSync(folder, { recursive: true }));

  const field = (name: string) => ui.viewer.page.getByLabel(name, { exact: true });

  it('is opened with the keyboard and shows the bindings of the file', async () => {
    const summary = ui.viewer.page.locator('.remote-panel summary');
    await summary.focus();
    await ui.viewer.page.keyboard.press('Enter');
    await ui.viewer.page.getByTestId('bindings').waitFor();
    assert.equal(await field('Upper of ABS_X').inputValue(), '50');
    assert.equal(await field('What BTN_EAST does').inputValue(), 'stop');
  });

  it('changes nothing without control', async () => {
    await ui.viewer.lookOn();
    assert.equal(await field('Upper of ABS_X').isDisabled(), true);
    assert.equal(await ui.viewer.button('Saved').isDisabled(), true);
  });

  it('changes a binding and saves it beside the scenario', async () => {
    await ui.viewer.takeControl();
    await field('Upper of ABS_X').fill('45');
    await field('Upper of ABS_X').press('Enter');
    await ui.viewer.button('Save').click();
    await ui.viewer.button('Saved').waitFor();
    const bindings = JSON.parse(readFileSync(file, 'utf8')).bindings as { upper?: number }[];
    assert.equal(bindings[0]?.upper, 45);
    await ui.viewer.screenshot('remote');
  });

  it('shows the value of the program again after a refusal, and why', async () => {
    await field('Upper of ABS_X').fill('500');
    await field('Upper of ABS_X').press('Enter');
    await ui.viewer.page.getByText('found limit 500, expected 0 to 90').waitFor();
    assert.equal(await field('Upper of ABS_X').inputValue(), '45');
  });

  it('makes an action of a parameter, and removes a binding', async () => {
    await field('What ABS_X does').selectOption('hold_to_run');
    await field('Upper of ABS_X').waitFor({ state: 'detached' });
    await ui.viewer.button('Remove the binding of BTN_EAST').click();
    await field('What BTN_EAST does').waitFor({ state: 'detached' });
  });
});
