// How soon the values of another tick are shown in a recording of an hour.
import { mkdtempSync, rmSync } from 'node:fs';
import { join } from 'node:path';
import { record } from '../browser/support/recorded.js';
import { uniform, UiProgram } from '../browser/support/ui_program.js';
import { Viewer } from '../browser/support/viewer.js';
import { Random } from '../support/random.js';
import type { Measurement } from './bench.js';

const seconds = 3600;
const seeks = 200;
const pause = 150; // milliseconds: the table shows at most ten rows a second
const readingTimeout = 15 * 60_000;

// Milliseconds from the press on the time line to the frame in which the table has the values of the tick.
function seekIn(share: number): Promise<number> {
  const track = document.querySelector('[data-testid=timeline]') as HTMLElement;
  const rows = document.querySelector('[data-testid=joints] tbody') as HTMLElement;
  const box = track.getBoundingClientRect();
  const begin = performance.now();
  track.dispatchEvent(new PointerEvent('pointermove', { buttons: 1, clientX: box.left + share * box.width, clientY: box.top + 5, bubbles: true }));
  return new Promise((done, failed) => {
    const look = () => {
      const milliseconds = performance.now() - begin;
      if (rows.dataset['tick'] === document.querySelector('[data-testid=tick]')?.textContent) done(milliseconds);
      else if (milliseconds > 10_000) failed(new Error('no values in 10 s'));
      else requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
  });
}

export const seek: Measurement = async ({ browser, log }) => {
  const folder = mkdtempSync(join(process.env['TMPDIR'] ?? '/var/tmp', 'proleg-seek-'));
  try {
    const file = join(folder, 'hour.proleg');
    log('recording an hour');
    // Without friction it moves its joints and stays on its floor.
    record(file, uniform, '--friction', '0', '--seconds', String(seconds));
    const program = await UiProgram.serve([file]);
    try {
      const viewer = await Viewer.open(browser, program.address);
      const { page } = viewer;
      log('reading it');
      const begin = performance.now();
      await page.getByTestId('indexing').waitFor({ state: 'detached', timeout: readingTimeout });
      log(`read in ${Math.round((performance.now() - begin) / 1000)} s`);
      const random = new Random(1);
      const samples: number[] = [];
      for (let i = 0; i < seeks; i += 1) {
        await page.waitForTimeout(pause);
        samples.push(await page.evaluate(seekIn, random.next()));
      }
      await viewer.close();
      const conditions = 'from the press on the time line to the values in the table of joints; 360,000 ticks, five joints';
      return [{ name: 'seek in an hour of recording', unit: 'ms', wanted: { p99: 50 }, conditions, samples }];
    } finally {
      await program.end();
    }
  } finally {
    rmSync(folder, { recursive: true });
  }
};
