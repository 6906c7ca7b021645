// Two recordings in one view: what differs is what the tables of `proleg export` say.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import type { Browser } from 'playwright-core';
import { launchBrowser } from './support/browser.js';
import { countPixelsWhen } from './support/pixels.js';
import { record, tableOf } from './support/recorded.js';
import { UiProgram, uniform } from './support/ui_program.js';
import { Viewer } from './support/viewer.js';

type Table = Record<string, number>[];

const joints = ['J5', 'J4', 'J3', 'J2', 'J1'];

function firstDifference(one: Table, other: Table): number {
  return one.findIndex((row, tick) => joints.some((joint) => row[`setpoint_deg.${joint}`] !== other[tick]?.[`setpoint_deg.${joint}`]));
}

// Metres on the ground between the first and the last row.
function wayOf(table: Table): string {
  const head = Object.keys(table[0] ?? {}).find((name) => name.startsWith('x_m.'))?.slice('x_m.'.length);
  const [first, last] = [table[0] ?? {}, table.at(-1) ?? {}];
  const way = (axis: string) => (last[`${axis}_m.${head}`] ?? NaN) - (first[`${axis}_m.${head}`] ?? NaN);
  return `${Math.hypot(way('x'), way('y')).toFixed(3)} m`;
}

// The green of the ghost, light and dark.
const isGhost = (red: number, green: number, blue: number) => green > red + 12 && green > blue + 4;

describe('two recordings', () => {
  let folder: string;
  let browser: Browser;
  let served: UiProgram;
  const path = (name: string) => join(folder, `${name}.proleg`);
  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'proleg-page-'));
    const more = ['--seconds', '10'];
    record(path('one'), uniform, ...more);
    record(path('same'), uniform, ...more);
    record(path('other'), uniform, ...more, '--set', 'amplitude=25@500');
    record(path('short'), uniform, '--seconds', '3');
    record(path('twenty'), 'sim/scenarios/long_chain/twenty.simulation.xml', '--seconds', '1');
    browser = await launchBrowser();
    served = await UiProgram.serve([folder]);
  });
  after(async () => {
    await served.end();
    await browser.close();
    rmSync(folder, { recursive: true });
  });

  // From the list, by mouse.
  async function compare(viewer: Viewer, one: string, other: string): Promise<void> {
    await viewer.button(`Compare ${one}.proleg with another recording`).click();
    await viewer.page.getByTestId('comparing').getByText(`${one}.proleg`).waitFor();
    await viewer.button(`${other}.proleg`).click();
  }

  it('differ from the tick on at which a parameter was changed', async () => {
    const [one, other] = [tableOf(path('one')), tableOf(path('other'))];
    const difference = firstDifference(one, other);
    assert.ok(difference >= 500);
    const viewer = await Viewer.openList(browser, served.address);
    const { page } = viewer;
    await compare(viewer, 'one', 'other');
    const band = page.getByTestId('comparison');
    await band.getByText(`the set-points differ from tick ${difference} on`).waitFor();
    await band.getByText(`head: ${wayOf(one)}, second ${wayOf(other)}`).waitFor();
    await viewer.button(`To tick ${difference}`).click();
    await page.waitForFunction((tick) => document.querySelector('[data-testid=tick]')?.textContent === tick, String(difference));
    // At the end: values of the first, and how the second differs.
    await page.keyboard.press('End');
    const expected = joints.map((joint) => {
      const [own, second] = [one.at(-1)?.[`angle_deg.${joint}`] ?? NaN, other.at(-1)?.[`angle_deg.${joint}`] ?? NaN];
      return [own, second - own].map((value) => value.toFixed(1).replace(/^-0\.0$/, '0.0'));
    });
    await page.waitForFunction(
      (wanted) =>
        [...document.querySelectorAll('[data-testid=joints] tbody tr')]
          .map((row) => ['angle', 'Δ angle'].map((name) => row.querySelector(`td[data-value="${name}"]`)?.textContent).join())
          .join(';') === wanted,
      expected.map((row) => row.join()).join(';'),
    );
    await page.locator('.line-chips .value').filter({ hasText: '|' }).first().waitFor();
    const scene = page.getByTestId('scene');
    const withGhost = await countPixelsWhen(page, scene, isGhost, (count) => count > 200);
    await viewer.screenshot('compared');
    await viewer.button('End').click();
    await page.locator('[data-testid=joints] td[data-value=lag]').first().waitFor();
    const withoutGhost = await countPixelsWhen(page, scene, isGhost, (count) => count + 200 < withGhost);
    assert.ok(withGhost > withoutGhost + 200, `${withGhost} green pixels with a ghost, ${withoutGhost} without`);
    await viewer.close();
  });

  it('are the same bit for bit, or as far as the shorter one goes', async () => {
    const viewer = await Viewer.openList(browser, served.address);
    const { page } = viewer;
    await compare(viewer, 'one', 'same');
    const band = page.getByTestId('comparison');
    await band.getByText('the same set-points in all 1000 ticks, bit for bit').waitFor();
    // With keys: another one.
    await page.keyboard.press('d');
    await page.keyboard.press('d');
    await viewer.button('short.proleg').focus();
    await page.keyboard.press('Enter');
    await band.getByText('ticks 0 to 299 are in both; the same set-points in all 300 ticks').waitFor();
    // Behind its end there is nothing of it.
    await page.keyboard.press('End');
    await page.locator('[data-testid=joints] tbody[data-tick="999"] td[data-value="Δ angle"]').filter({ hasText: '–' }).first().waitFor();
    await viewer.close();
  });

  it('that have other robots are refused in one line', async () => {
    const viewer = await Viewer.openList(browser, served.address);
    const { page } = viewer;
    await compare(viewer, 'one', 'twenty');
    await page.getByRole('alert').getByText('twenty.proleg: found 20 joints, expected 5, as in one.proleg').waitFor();
    await viewer.button('Cancel').click();
    await page.getByTestId('opened').getByText('one.proleg').waitFor();
    await viewer.close();
  });
});
