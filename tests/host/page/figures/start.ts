// How soon the page is there, and how large it is.
import { readFileSync } from 'node:fs';
import { uniform, UiProgram } from '../browser/support/ui_program.js';
import { Viewer } from '../browser/support/viewer.js';
import { probe, type Measurement } from './bench.js';
import { installProbe } from './page_probe.js';

const loads = 20;
const kilobyte = 1024;

export const start: Measurement = async ({ browser }) => {
  const program = await UiProgram.start(uniform);
  const paints: number[] = [];
  const usable: number[] = [];
  try {
    for (let i = 0; i < loads; i += 1) {
      // A context of its own: nothing is in its cache.
      const viewer = await Viewer.open(browser, program.address, {}, installProbe);
      await viewer.page.waitForFunction(() => window.figures.usable !== null);
      usable.push((await probe(viewer.page)).usable as number);
      paints.push(await viewer.page.evaluate(() => performance.getEntriesByName('first-paint')[0]?.startTime ?? NaN));
      await viewer.close();
    }
  } finally {
    await program.end();
  }
  return [
    { name: 'first paint', unit: 'ms', wanted: { p99: 200 }, conditions: 'since the navigation began; nothing in the cache', samples: paints },
    {
      name: 'usable',
      unit: 'ms',
      wanted: { p99: 1000 },
      conditions: 'connected; STOP, control, parameters, 3D view and table of joints are there',
      samples: usable,
    },
  ];
};

// As tools/page has measured them.
export const sizes: Measurement = async () => {
  const { first, all } = JSON.parse(readFileSync('build/page_sizes.json', 'utf8')) as { first: number; all: number };
  return [
    { name: 'first chunk, compressed', unit: 'kB', wanted: { median: 40 }, conditions: 'gzip -9; top bar, STOP and connection', samples: [first / kilobyte] },
    { name: 'page, compressed', unit: 'kB', wanted: { median: 220 }, conditions: 'gzip -9', samples: [all / kilobyte] },
  ];
};
