// Parameters: written into the file, and the table of all values.
import assert from 'node:assert/strict';
import { appendFileSync, cpSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, describe, it } from 'node:test';
import type { Locator } from 'playwright-core';
import { useUi } from './support/ui_fixture.js';
import { UiProgram } from './support/ui_program.js';
import { waitUntil } from './support/waiting.js';

describe('parameters of a robot with files', () => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-tuned-'));
  const file = `${folder}/uniform.actuation.xml`;
  after(() => rmSync(folder, { recursive: true, force: true }));
  const copyAndStart = () => {
    cpSync('sim/scenarios/travelling_wave', folder, { recursive: true });
    return UiProgram.start(`${folder}/uniform.simulation.xml`, ['--recordings', folder]);
  };
  const ui = useUi(copyAndStart, { takesControl: true });

  const type = async (parameter: string, value: string) => {
    const field = ui.viewer.parameter(parameter).getByRole('textbox').first();
    await field.fill(value);
    await field.press('Enter');
  };
  const press = (...keys: string[]) =>
    keys.reduce((before, key) => before.then(() => ui.viewer.page.keyboard.press(key)), Promise.resolve());

  it('are written into the file where they are chosen, from the keyboard alone', async () => {
    const text = readFileSync(file, 'utf8');
    await type('1.frequency', '0.5');
    await ui.viewer.parameter('1.amplitude').locator('[data-cell="3"]').focus();
    // The pointer may come to another joint while a number is typed.
    await press('2');
    await ui.viewer.parameter('1.frequency').locator('[data-cell="1"]').hover();
    await ui.viewer.parameter('1.amplitude').locator('[data-cell="1"].hovered').waitFor();
    await press('0', 'Enter', 'w');
    const diff = ui.viewer.page.getByTestId('diff');
    const rows = diff.getByRole('listitem');
    await rows.nth(1).waitFor();
    assert.equal(await rows.count(), 2);
    assert.match((await rows.first().textContent()) ?? '', /amplitude of J2new, after line 8/);
    await ui.viewer.screenshot('apply_to_file');
    // Close, All, None, the first line, the second one.
    await press('Tab', 'Tab', 'Tab', 'Tab', 'Enter');
    await ui.viewer.button('Write 1 change').waitFor();
    await press('Tab', 'Enter');
    await diff.waitFor({ state: 'detached' });
    const added = '    <parameter name="amplitude" value="20" unit="deg" joint="J2"/>\n';
    const common = '    <parameter name="amplitude" value="40" unit="deg"/>\n';
    assert.equal(readFileSync(file, 'utf8'), text.replace(common, common + added));
    const valuesInFile = async (name: string) => (await ui.viewer.valuesOf(name)).map((value) => value.file).join();
    assert.ok(await waitUntil(async () => (await valuesInFile('1.amplitude')) === '40,40,40,20,40'));
    assert.equal(await valuesInFile('1.frequency'), '1,1,1,1,1');
  });

  it('are not written over what another program has written', async () => {
    appendFileSync(file, '<!-- another hand -->\n');
    const text = readFileSync(file, 'utf8');
    await ui.viewer.button('Apply to file…').click();
    await ui.viewer.button('Write 1 change').click();
    await ui.viewer.page.getByRole('alert').filter({ hasText: 'found a file that has changed' }).waitFor();
    assert.equal(readFileSync(file, 'utf8'), text);
    await ui.viewer.button('Close').click();
  });

  it('are copied from the table, and pasted into it as one change', async () => {
    await ui.viewer.parameter('1.frequency').getByRole('textbox').first().press('Tab');
    await ui.viewer.page.getByTestId('scene').focus();
    await press('v');
    const table = ui.viewer.page.getByTestId('value-table');
    await table.waitFor();
    const cell = (row: number, column: number) => table.locator(`[data-at="${row},${column}"]`);
    await cell(0, 1).focus();
    await pasteInto(cell(0, 1), '11\t12,5\r\n0.5\t0.25\r\n');
    await ui.viewer.page.waitForFunction(() => document.querySelector<HTMLInputElement>('[data-at="0,2"]')?.value === '12.5');
    assert.deepEqual(await textsOf(0), ['40', '11', '12.5', '20', '40']);
    await cell(0, 1).focus();
    await press('Shift+ArrowRight', 'Shift+ArrowRight', 'Shift+ArrowDown');
    await ui.viewer.screenshot('value_table');
    assert.equal(await copyFrom(cell(0, 1)), '11\t12.5\t20\n0.5\t0.25\t0.5');
    await press('Control+z');
    await ui.viewer.page.waitForFunction(() => document.querySelector<HTMLInputElement>('[data-at="0,2"]')?.value === '40');
    assert.deepEqual(await textsOf(0), ['40', '40', '40', '20', '40']);
  });

  it('stay as they are if a cell of what is pasted is bad, and the cell is marked', async () => {
    const cell = ui.viewer.page.locator('[data-at="0,1"]');
    await pasteInto(cell, '5\t6\tmuch');
    await ui.viewer.page.getByRole('alert').filter({ hasText: "J2: found 'much', expected a number" }).waitFor();
    assert.equal(await ui.viewer.page.locator('[data-at="0,3"]').getAttribute('aria-invalid'), 'true');
    await ui.viewer.screenshot('value_table_problem');
    assert.deepEqual(await textsOf(0), ['40', '40', '40', '20', '40']);
    await cell.fill('7,5');
    await press('Enter');
    await ui.viewer.page.waitForFunction(() => document.querySelector<HTMLInputElement>('[data-at="0,1"]')?.value === '7.5');
    await ui.viewer.button('Close').click();
  });

  it('are saved as a robot of one\'s own, with all its files', async () => {
    await ui.viewer.button('Apply to file…').click();
    await ui.viewer.page.getByLabel('Save as').fill('my wave');
    await ui.viewer.button('Save a copy').click();
    await ui.viewer.page.getByText(/saved as .*my wave\/uniform.simulation.xml/).waitFor();
    const saved = readFileSync(`${folder}/my wave/uniform.actuation.xml`, 'utf8');
    assert.match(saved, /name="amplitude" value="7.5" unit="deg" joint="J4"/);
    await ui.viewer.button('Apply to file…').click();
    await ui.viewer.page.getByText('The file has the wanted values.').waitFor();
    await ui.viewer.button('Close').click();
  });

  const textsOf = (row: number) =>
    ui.viewer.page.locator(`[data-at^="${row},"]`).evaluateAll((cells) => cells.map((cell) => (cell as HTMLInputElement).value));
  const pasteInto = (cell: Locator, text: string) =>
    cell.evaluate((element, pasted) => {
      const clipboardData = new DataTransfer();
      clipboardData.setData('text/plain', pasted);
      element.dispatchEvent(new ClipboardEvent('paste', { clipboardData, bubbles: true, cancelable: true }));
    }, text);
  const copyFrom = (cell: Locator) =>
    cell.evaluate((element) => {
      const clipboardData = new DataTransfer();
      element.dispatchEvent(new ClipboardEvent('copy', { clipboardData, bubbles: true, cancelable: true }));
      return clipboardData.getData('text/plain');
    });
});
