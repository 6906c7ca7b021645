// From the user's hand to the robot: a slider, STOP.
import { sixty, uniform } from '../browser/support/ui_program.js';
import type { Viewer } from '../browser/support/viewer.js';
import { probe, withLivePage, type Measurement } from './bench.js';
import { sleep } from './processes.js';
import type { Figure } from './report.js';

const changes = 150;
const stops = 60;
const quietRows = 10;
const patience = 10000; // milliseconds until an effect is there

// Only the slider may move the set-points: the amplitude is 0, and a filter in the gait comes to rest soon.
const robots = [
  { file: uniform, joints: 5, still: ['--set', 'amplitude=0'] },
  { file: sixty, joints: 60, still: ['--set', 'amplitude=0', '--set', 'rate=100'] },
];

async function waitForEffect(viewer: Viewer, what: 'changes' | 'stops' | 'quiet_rows', least: number): Promise<void> {
  const isThere = ([name, count]: readonly ['changes' | 'stops' | 'quiet_rows', number]) => {
    const noted = window.figures[name];
    return (typeof noted === 'number' ? noted : noted.length) >= count;
  };
  await viewer.page.waitForFunction(isThere, [what, least] as const, { timeout: patience, polling: 5 });
}

async function sliderDelays(viewer: Viewer): Promise<number[]> {
  await viewer.page.evaluate(() => (window.figures.watches_setpoints = true));
  const slider = viewer.parameter('1.offset').getByRole('slider').first();
  await slider.focus();
  for (let i = 0; i < changes; i += 1) {
    await waitForEffect(viewer, 'quiet_rows', quietRows);
    await sleep(i % 10); // all phases of a tick
    await viewer.page.keyboard.press(i % 2 === 0 ? 'ArrowRight' : 'ArrowLeft');
    await waitForEffect(viewer, 'changes', i + 1);
  }
  return (await probe(viewer.page)).changes;
}

async function stopDelays(viewer: Viewer): Promise<number[]> {
  for (let i = 0; i < stops; i += 1) {
    await sleep(100 + (i % 10));
    await viewer.page.keyboard.press('Escape');
    await waitForEffect(viewer, 'stops', i + 1);
    await viewer.waitForState('STOPPED');
    await viewer.run();
  }
  return (await probe(viewer.page)).stops;
}

export const sliderToSetpoint: Measurement = async (bench) => {
  const figures: Figure[] = [];
  for (const { file, joints, still } of robots) {
    figures.push({
      name: `slider to set-point, ${joints} joints`,
      unit: 'ms',
      wanted: { median: 15, p99: 30 },
      conditions: '3D on; from the key to the first row with another set-point in the page, with the wait for the tick (0 to 10 ms)',
      samples: await withLivePage(bench, file, sliderDelays, still),
    });
  }
  return figures;
};

export const stopToStopped: Measurement = async (bench) => {
  const figures: Figure[] = [];
  for (const { file, joints } of robots) {
    figures.push({
      name: `STOP to all stopped, ${joints} joints`,
      unit: 'ms',
      wanted: { p99: 25 },
      conditions: '3D on; from the key Esc to the answer in the page that all joints have stopped',
      samples: await withLivePage(bench, file, stopDelays),
    });
  }
  return figures;
};
