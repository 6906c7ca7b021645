// What the page costs while a search runs beside it, and how well the time of a search is estimated.
import { execFileSync, spawn } from 'node:child_process';
import { cpSync, mkdirSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { program as proleg, UiProgram } from '../browser/support/ui_program.js';
import { Viewer } from '../browser/support/viewer.js';
import { periods, type Measurement } from './bench.js';
import { descendants, processorTime, sleep, sum } from './processes.js';
import { quantile } from './report.js';

const windows = 10;
const windowSeconds = 5;
const settling = 3000; // milliseconds until the page has shown what there is

interface Cost {
  program: number[]; // % of a core, of each window
  browser: number[];
}

async function costOf(program: number, browsers: readonly number[]): Promise<Cost> {
  const parts = await periods(windows, windowSeconds * 1000, async () => ({
    program: processorTime(program),
    browser: sum(browsers.map(processorTime)),
  }));
  const share = (of: keyof Cost) => parts.map(({ before, after, ms }) => (100 * (after[of] - before[of])) / ms);
  return { program: share('program'), browser: share('browser') };
}

const pageCost: Measurement = async ({ browser, log }) => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-figures-'));
  cpSync('sim/scenarios/travelling_wave', folder, { recursive: true });
  mkdirSync(join(folder, 'searches'));
  const out = join(folder, 'searches/wave');
  const program = await UiProgram.start(join(folder, 'uniform.simulation.xml'), ['--recordings', folder]);
  try {
    const viewer = await Viewer.open(browser, program.address);
    const { page } = viewer;
    const browsers = descendants(process.pid, 'chromium');
    await page.keyboard.press('3');
    await page.getByRole('tab', { name: 'Search', exact: true }).click();
    await page.getByText('There is no search yet').waitFor();
    await sleep(settling);
    log('without a search');
    const without = await costOf(program.pid, browsers);
    const words = [join(folder, 'cma_es.optimise.xml'), '--engine', 'reduced', '--evaluations', '1000000', '--workers', '1', '--out', out];
    const search = spawn(proleg, ['optimise', ...words], { stdio: 'ignore' });
    const ended = new Promise((resolve) => search.once('exit', resolve));
    let shown: Cost;
    let hidden: Cost;
    try {
      await page.getByTestId('searches').getByRole('button', { name: 'wave' }).click();
      await page.getByTestId('candidates').waitFor();
      await sleep(settling);
      log('with a search that the page shows');
      shown = await costOf(program.pid, browsers);
      await page.keyboard.press('1');
      await sleep(settling);
      log('with a search that the page does not show');
      hidden = await costOf(program.pid, browsers);
    } finally {
      execFileSync(proleg, ['optimise', '--stop', out], { stdio: 'ignore' });
      await ended;
    }
    await sleep(settling);
    log('after it');
    const live = await costOf(program.pid, browsers);
    await viewer.close();
    const more = (present: number[], alone: number[]) => present.map((value) => value - quantile(alone, 0.5));
    const both = ({ program: one, browser: other }: Cost) => one.map((value, i) => value + (other[i] as number));
    const figure = (name: string, samples: number[], conditions: string, wanted = {}) => ({ name, unit: '% of a core', wanted, conditions, samples });
    const seen = `the page shows its curve, points and candidates; more than the same page without a search; one worker, reduced engine, a paused robot, WebGL in software; ${windowSeconds} s each`;
    const unseen = `the page shows the paused robot; more than the same page after the search; ${windowSeconds} s each`;
    return [
      figure('page cost of a running search, program and browser', more(both(shown), both(without)), seen, { median: 2 }),
      figure('page cost of a running search, proleg ui alone', more(shown.program, without.program), seen),
      figure('page cost of a running search that is not shown', more(both(hidden), both(live)), unseen, { median: 2 }),
    ];
  } finally {
    await program.end();
    rmSync(folder, { recursive: true });
  }
};

const searches = [
  { engine: 'reduced', evaluations: 2000 },
  { engine: 'ode', evaluations: 150 },
];
const repetitions = 3;

const timeEstimate: Measurement = async ({ log }) => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-figures-'));
  const file = 'sim/scenarios/travelling_wave/cma_es.optimise.xml';
  const optimise = (...words: string[]) => JSON.parse(execFileSync(proleg, ['optimise', file, ...words, '--json'], { encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] }));
  const samples: number[] = [];
  try {
    for (const { engine, evaluations } of searches) {
      for (let times = 0; times < repetitions; times += 1) {
        const words = ['--engine', engine, '--evaluations', String(evaluations)];
        const { seconds } = optimise(...words, '--estimate') as { seconds: number };
        const begin = performance.now();
        optimise(...words, '--out', join(folder, `${engine}_${times}`));
        const taken = (performance.now() - begin) / 1000;
        log(`${engine}: estimated ${seconds.toFixed(1)} s, taken ${taken.toFixed(1)} s`);
        samples.push(100 * Math.abs(seconds / taken - 1));
      }
    }
  } finally {
    rmSync(folder, { recursive: true });
  }
  const conditions = `${searches.map(({ engine, evaluations }) => `${evaluations} evaluations with ${engine}`).join(', ')}; as many workers as processors; from the start to the end of the program`;
  return [{ name: 'time of a search against its estimate, off by', unit: '%', wanted: { p99: 30 }, conditions, samples }];
};

export const search: Measurement = async (bench) => [...(await pageCost(bench)), ...(await timeEstimate(bench))];
