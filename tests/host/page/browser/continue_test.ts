// A recorded simulation goes on from a tick: the ticks before are the recorded ones, then the user drives.
import assert from 'node:assert/strict';
import { mkdtempSync, readdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import type { Browser } from 'playwright-core';
import { launchBrowser } from './support/browser.js';
import { record, tableOf } from './support/recorded.js';
import { UiProgram, uniform } from './support/ui_program.js';
import { Viewer } from './support/viewer.js';

const live = '.live:not(.recorded)';

describe('a recorded simulation', () => {
  let folder: string;
  let browser: Browser;
  let table: Record<string, number>[];
  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'proleg-page-'));
    record(join(folder, 'run.proleg'), uniform, '--seconds', '10', '--set', 'amplitude=30@200', '--move', '1,0.5,0.1,90@300');
    table = tableOf(join(folder, 'run.proleg'));
    browser = await launchBrowser();
  });
  after(async () => {
    await browser.close();
    rmSync(folder, { recursive: true });
  });

  async function waitForRow(viewer: Viewer, tick: number): Promise<void> {
    const expected = ['J5', 'J4', 'J3', 'J2', 'J1'].map((joint) =>
      (table[tick]?.[`angle_deg.${joint}`] ?? NaN).toFixed(1).replace(/^-0\.0$/, '0.0'),
    );
    await viewer.page.waitForFunction(
      ([cells, wanted]) => [...document.querySelectorAll(cells)].map((cell) => cell.textContent).join() === wanted,
      [`${live} [data-testid=joints] td[data-value=angle]`, expected.join()] as const,
    );
  }

  for (const [what, words] of [
    ['where there was no robot', () => [join(folder, 'run.proleg')]],
    ['instead of the present simulation', () => [uniform, '--paused', '--recordings', folder]],
  ] as const) {
    it(`goes on ${what}`, async () => {
      const served = await UiProgram.serve(words());
      try {
        const viewer = await Viewer.open(browser, served.address);
        const { page } = viewer;
        if ((await page.getByTestId('opened').count()) === 0) {
          await page.keyboard.press('2');
          await viewer.button('run.proleg').click();
        }
        await page.getByTestId('opened').waitFor();
        const button = viewer.button('Continue from here');
        await viewer.lookOn();
        assert.match((await button.getAttribute('title')) ?? '', /Take control first/);
        await viewer.takeControl();
        const timeline = await page.getByTestId('timeline').boundingBox();
        assert.ok(timeline);
        await page.mouse.click(timeline.x + timeline.width * 0.6, timeline.y + timeline.height / 2);
        const shown = page.locator('.recorded [data-testid=tick]').filter({ hasText: /^(5|6)\d\d$/ });
        await shown.waitFor();
        const tick = Number(await shown.textContent());
        await button.click();
        await page.locator(`${live} [data-testid=scene]`).waitFor();
        await viewer.waitForState('paused');
        await waitForRow(viewer, tick);
        await page.getByText(`run.proleg: computed again up to tick ${tick}, with the same set-points`).waitFor();
        await viewer.screenshot('continued');
        // The next ticks are the recorded ones, too, until something is changed.
        await page.locator(`${live} input[aria-label="Ticks of a step"]`).fill('20');
        await viewer.button('Step').click();
        await waitForRow(viewer, tick + 20);
        // It is recorded from tick 0 on.
        await page.keyboard.press('r');
        await viewer.button('Recording').waitFor();
        await page.keyboard.press('r');
        await viewer.button('Record').waitFor();
        const again = readdirSync(folder).find((name) => name !== 'run.proleg' && name.endsWith('.proleg'));
        assert.ok(again);
        const rows = tableOf(join(folder, again));
        assert.equal(rows.length, tick + 21);
        assert.deepEqual(rows, table.slice(0, tick + 21));
        rmSync(join(folder, again));
        await viewer.close();
      } finally {
        await served.end();
      }
    });
  }
});
