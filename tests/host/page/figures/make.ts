// The page Make: from a slider to the drawn path of the next half minute, from a click to the new robot; and what 200 objects
// cost the 3D view.
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import type { Page } from 'playwright-core';
import { uniform } from '../browser/support/ui_program.js';
import type { Viewer } from '../browser/support/viewer.js';
import { withLivePage, type Measurement } from './bench.js';
import { countFrames } from './drawing.js';
import { sleep } from './processes.js';

const changes = 100;
const seconds = 20;
const settling = 5000; // milliseconds: the view chooses its resolution
const objects = 200;
const patience = 10000; // milliseconds until an effect is there

// Milliseconds from the next key or click in the page to the next change of what `watched` selects.
async function untilChanged(page: Page, watched: string, act: () => Promise<void>): Promise<number> {
  await page.evaluate(([selector, limit]) => {
    const scope = window as unknown as { delay: Promise<number> };
    scope.delay = new Promise((resolve, reject) => {
      let begin: number | null = null;
      const note = (event: Event) => (begin ??= event.timeStamp);
      for (const name of ['keydown', 'click']) addEventListener(name, note, { capture: true, once: true });
      const text = () => document.querySelector(selector as string)?.outerHTML;
      const before = text();
      const observer = new MutationObserver(() => {
        if (begin === null || text() === before) return;
        observer.disconnect();
        resolve(performance.now() - begin);
      });
      observer.observe(document.body, { subtree: true, childList: true, attributes: true, characterData: true });
      setTimeout(() => reject(new Error(`${selector} has not changed`)), limit as number);
    });
  }, [watched, patience] as const);
  await act();
  return page.evaluate(() => (window as unknown as { delay: Promise<number> }).delay);
}

export const make: Measurement = async (bench) => [...(await editFigures(bench)), ...(await objectFrames(bench))];

const editFigures: Measurement = async (bench) => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-figures-')); // for unsaved changes
  const edit = async ({ page }: Viewer) => {
    await page.keyboard.press('3');
    await page.getByRole('tab', { name: 'Behaviour' }).click();
    await page.locator('.foresight-text:not(.old)').waitFor();
    await page.locator('[data-parameter=frequency]').getByRole('slider').focus();
    const paths: number[] = [];
    for (let i = 0; i < changes; i += 1) {
      paths.push(await untilChanged(page, '[data-testid=map-top] .foresight', () => page.keyboard.press(i % 20 < 10 ? 'ArrowRight' : 'ArrowLeft')));
      await sleep(20 + (i % 10));
    }
    await page.getByRole('tab', { name: 'Robot' }).click();
    await page.getByTestId('chain').getByRole('button', { name: 'J2', exact: true }).click();
    const robots: number[] = [];
    for (let i = 0; i < changes / 2; i += 1) {
      const name = i % 2 === 0 ? 'Add a copy' : 'Undo';
      robots.push(await untilChanged(page, '[data-testid=map-top] .robot', () => page.getByRole('button', { name, exact: true }).click()));
      await sleep(100);
    }
    const conditions = 'five joints, beside the live simulation';
    return [
      { name: 'slider to the drawn path of the next half minute', unit: 'ms', wanted: { median: 50 }, conditions, samples: paths },
      { name: 'click to the new robot in the drawings', unit: 'ms', wanted: { median: 100 }, conditions, samples: robots },
    ];
  };
  try {
    return await withLivePage(bench, uniform, edit, ['--recordings', folder]);
  } finally {
    rmSync(folder, { recursive: true });
  }
};

// Sixty joints in a world of many objects.
const objectFrames: Measurement = async (bench) => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-figures-'));
  try {
    cpSync('sim/scenarios', folder, { recursive: true });
    const world = join(folder, 'travelling_wave/flat.environment.xml');
    const boxes = Array.from({ length: objects }, (_, i) => {
      const place = `${(i % 20) - 10} ${5 + Math.floor(i / 20)} 0.05`;
      return `<KinBody><Body type="static"><Translation>${place}</Translation><Geom type="box"><extents>0.1 0.1 0.05</extents></Geom></Body></KinBody>\n`;
    });
    writeFileSync(world, readFileSync(world, 'utf8').replace('</Environment>', `${boxes.join('')}</Environment>`));
    return await withLivePage(bench, join(folder, 'long_chain/sixty.simulation.xml'), async ({ page }) => {
      const frames = await countFrames(page);
      await sleep(settling);
      const first = (await frames()).length;
      await sleep(seconds * 1000);
      const times = (await frames()).slice(first);
      const start = times[0] as number;
      const samples = Array.from({ length: seconds - 1 }, (_, i) => {
        const from = start + 1000 * i;
        return times.filter((time) => time >= from && time < from + 1000).length;
      });
      const conditions = `a robot that moves, page of 1400 x 900, WebGL in software, ${seconds} s`;
      return [{ name: `3D frames, 60 joints and ${objects} objects`, unit: '1/s', wanted: { median: 30, least: true }, conditions, samples }];
    });
  } finally {
    rmSync(folder, { recursive: true });
  }
};
