// Parameters: written into the file.
import assert from 'node:assert/strict';
import { appendFileSync, cpSync, readFileSync, rmSync } from 'node:fs';
import { after, before, describe, it } from 'node:test';
import type { Browser } from 'playwright-core';
import { launchBrowser } from './support/browser.js';
import { UiProgram } from './support/ui_program.js';
import { Viewer } from './support/viewer.js';

const folder = 'build/page_test/tuned';
const file = `${folder}/uniform.actuation.xml`;

describe('parameters of a robot with files', () => {
  let browser: Browser;
  let program: UiProgram;
  let viewer: Viewer;

  before(async () => {
    rmSync(folder, { recursive: true, force: true });
    cpSync('sim/scenarios/travelling_wave', folder, { recursive: true });
    browser = await launchBrowser();
    program = await UiProgram.start(`${folder}/uniform.simulation.xml`);
    viewer = await Viewer.open(browser, program.address);
    await viewer.takeControl();
  });

  after(async () => {
    await viewer.close();
    await program.end();
    await browser.close();
  });

  const type = async (parameter: string, value: string) => {
    const field = viewer.parameter(parameter).getByRole('textbox').first();
    await field.fill(value);
    await field.press('Enter');
  };
  const press = (...keys: string[]) =>
    keys.reduce((before, key) => before.then(() => viewer.page.keyboard.press(key)), Promise.resolve());

  it('are written into the file where they are chosen, from the keyboard alone', async () => {
    const text = readFileSync(file, 'utf8');
    await type('1.frequency', '0.5');
    await viewer.parameter('1.amplitude').locator('[data-cell="3"]').focus();
    await viewer.page.keyboard.type('20');
    await press('Enter', 'w');
    const diff = viewer.page.getByTestId('diff');
    const rows = diff.getByRole('listitem');
    await rows.nth(1).waitFor();
    assert.equal(await rows.count(), 2);
    assert.match((await rows.first().textContent()) ?? '', /amplitude of J2new, after line 9/);
    await viewer.screenshot('apply_to_file');
    // Close, All, None, the first line, the second one.
    await press('Tab', 'Tab', 'Tab', 'Tab', 'Enter');
    await viewer.button('Write 1 change').waitFor();
    await press('Tab', 'Enter');
    await diff.waitFor({ state: 'detached' });
    const added = '    <parameter name="amplitude" value="20" unit="deg" joint="J2"/>\n';
    const common = '    <parameter name="amplitude" value="40" unit="deg"/>\n';
    assert.equal(readFileSync(file, 'utf8'), text.replace(common, common + added));
    const values = await viewer.valuesOf('1.amplitude');
    assert.deepEqual(values.map((value) => value.file), ['40', '40', '40', '20', '40']);
    assert.deepEqual((await viewer.valuesOf('1.frequency')).map((value) => value.file), ['1', '1', '1', '1', '1']);
  });

  it('are not written over what another program has written', async () => {
    appendFileSync(file, '<!-- another hand -->\n');
    const text = readFileSync(file, 'utf8');
    await viewer.button('Apply to file…').click();
    await viewer.button('Write 1 change').click();
    await viewer.page.getByRole('alert').filter({ hasText: 'found a file that has changed' }).waitFor();
    assert.equal(readFileSync(file, 'utf8'), text);
    await viewer.button('Close').click();
  });
});
