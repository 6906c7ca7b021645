// A long recording scrubs: at each tick the page shows what the file has.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { after, before, describe, it } from 'node:test';
import type { Browser } from 'playwright-core';
import { Random } from '../support/random.js';
import { launchBrowser } from './support/browser.js';
import { record } from './support/recorded.js';
import { program, UiProgram, uniform } from './support/ui_program.js';
import { Viewer } from './support/viewer.js';

const seconds = 600;
const ticks = seconds * 100;
const seeks = 40;

// The angles of each tick, of the joints from the head, as `proleg export` writes them.
async function anglesOf(file: string): Promise<number[][]> {
  const table = spawn(program, ['export', file, '--out', '-'], { stdio: ['ignore', 'pipe', 'ignore'] });
  const angles: number[][] = [];
  let columns: number[] | null = null;
  for await (const line of createInterface({ input: table.stdout })) {
    const cells = line.split('\t');
    if (columns === null) {
      columns = cells.flatMap((name, column) => (name.startsWith('angle_deg.') ? [column] : []));
    } else {
      angles.push(columns.map((column) => Number(cells[column])));
    }
  }
  return angles;
}

describe('a long recording', () => {
  let folder: string;
  let browser: Browser;
  before(async () => {
    folder = mkdtempSync(join(process.env['TMPDIR'] ?? '/var/tmp', 'proleg-page-'));
    browser = await launchBrowser();
  });
  after(async () => {
    await browser.close();
    rmSync(folder, { recursive: true });
  });

  it('shows the values of every tick, also while it is read for the first time', async () => {
    const file = join(folder, 'long.proleg');
    // Without friction it moves its joints and stays on its floor.
    record(file, uniform, '--friction', '0', '--seconds', String(seconds));
    const angles = await anglesOf(file);
    assert.equal(angles.length, ticks);
    const seed = Date.now();
    console.log(`seed ${seed}`);
    const random = new Random(seed);
    const served = await UiProgram.serve([file]);
    try {
      const viewer = await Viewer.open(browser, served.address);
      const { page } = viewer;
      const track = await page.getByTestId('timeline').boundingBox();
      assert.ok(track);
      // The pointer stays down, as it does when a person scrubs.
      await page.mouse.move(track.x + 5, track.y + 10);
      await page.mouse.down();
      for (let seek = 0; seek < seeks; seek += 1) {
        if (seek === seeks / 2) {
          await page.getByTestId('indexing').waitFor({ state: 'detached', timeout: 300_000 });
        }
        await page.mouse.move(track.x + 2 + (track.width - 4) * random.next(), track.y + 10);
        const shown = await page.waitForFunction(() => {
          const rows = document.querySelector<HTMLElement>('[data-testid=joints] tbody');
          const tick = document.querySelector('[data-testid=timeline]')?.getAttribute('aria-valuenow');
          const cells = [...(rows?.querySelectorAll('td[data-value=angle]') ?? [])].map((cell) => cell.textContent);
          return rows?.dataset['tick'] === tick ? { tick: Number(tick), cells } : null;
        });
        const { tick, cells } = (await shown.jsonValue()) as { tick: number; cells: string[] };
        assert.deepEqual(cells, angles[tick]?.map((value) => value.toFixed(1).replace(/^-0\.0$/, '0.0')), `tick ${tick}`);
      }
      await page.mouse.up();
      await page.keyboard.press('End');
      await page.locator(`[data-testid=joints] tbody[data-tick="${ticks - 1}"]`).waitFor();
      await viewer.screenshot('long_recording');
      await viewer.close();
    } finally {
      await served.end();
    }
  });
});
