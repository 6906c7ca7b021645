// What the measurements share: a robot, a browser, a viewer that drives.
import type { Browser, Page } from 'playwright-core';
import { UiProgram } from '../browser/support/ui_program.js';
import { Viewer } from '../browser/support/viewer.js';
import { installProbe, type Probe } from './page_probe.js';
import { sleep } from './processes.js';
import type { Figure } from './report.js';

export interface Bench {
  browser: Browser;
  soakMinutes: number;
  log(text: string): void; // progress
}

export type Measurement = (bench: Bench) => Promise<Figure[]>;

// The page with a robot that runs, and control of it.
export async function withLivePage<T>(
  { browser }: Bench,
  file: string,
  use: (viewer: Viewer, program: UiProgram) => Promise<T>,
  options: string[] = [],
): Promise<T> {
  const program = await UiProgram.start(file, options);
  try {
    const viewer = await Viewer.open(browser, program.address, {}, installProbe);
    await viewer.takeControl();
    await viewer.run();
    const result = await use(viewer, program);
    await viewer.close();
    return result;
  } finally {
    await program.end();
  }
}

// What the probe has noted.
export const probe = (page: Page): Promise<Probe> => page.evaluate(() => window.figures);

// Differences of `read` over `count` periods.
export async function periods<T>(count: number, ms: number, read: () => Promise<T>): Promise<{ before: T; after: T; ms: number }[]> {
  const parts = [];
  let before = await read();
  let start = performance.now();
  for (let i = 0; i < count; i += 1) {
    await sleep(ms);
    const after = await read();
    const end = performance.now();
    parts.push({ before, after, ms: end - start });
    before = after;
    start = end;
  }
  return parts;
}
