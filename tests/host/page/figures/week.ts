// A project after a week of work: how soon its searches and recordings are listed, and what the lists cost in memory.
import { execFileSync } from 'node:child_process';
import { cpSync, mkdirSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import type { Page } from 'playwright-core';
import { record } from '../browser/support/recorded.js';
import { program as proleg, UiProgram } from '../browser/support/ui_program.js';
import { Viewer } from '../browser/support/viewer.js';
import type { Bench, Measurement } from './bench.js';
import { residentMemory } from './processes.js';

const searches = 200;
const recordings = 2000;
const starts = 4; // of the program
const pages = 3; // of each program, one after the other
const openings = 50; // in one page
const limit = 300; // milliseconds, of the design
const patience = 60_000; // milliseconds until a list is there
const settling = 5000; // milliseconds: all files are read
const starting = 3000; // milliseconds until a page that was opened is at rest: its robot is drawn

// A project with a small search and a short recording, each copied often.
export function makeWeek(folder: string): string {
  const scenario = join(folder, 'uniform.simulation.xml');
  cpSync('sim/scenarios/travelling_wave', folder, { recursive: true });
  const run = join(folder, 'day_0/run_0000.proleg');
  mkdirSync(join(folder, 'day_0'));
  record(run, scenario, '--seconds', '0.5');
  for (let number = 1; number < recordings; number += 1) {
    const day = join(folder, `day_${number % 7}`);
    mkdirSync(day, { recursive: true });
    cpSync(run, join(day, `run_${String(number).padStart(4, '0')}.proleg`));
  }
  const search = join(folder, 'searches/wave_000');
  mkdirSync(join(folder, 'searches'));
  const words = [join(folder, 'cma_es.optimise.xml'), '--engine', 'reduced', '--evaluations', '40', '--out', search];
  execFileSync(proleg, ['optimise', ...words], { stdio: ['ignore', 'ignore', 'pipe'] });
  for (let number = 1; number < searches; number += 1) {
    cpSync(search, join(folder, `searches/wave_${String(number).padStart(3, '0')}`), { recursive: true });
  }
  return scenario;
}

interface List {
  open(page: Page): Promise<void>; // by one key or click
  leave(page: Page): Promise<void>;
  table: string; // the test id of its table
  rest: RegExp; // the text of the button for what the page does not show at first
}

const recordingList: List = {
  open: (page) => page.keyboard.press('2'),
  leave: (page) => page.keyboard.press('3'),
  table: 'recordings',
  rest: /of 1,?950 more/,
};

const searchList: List = {
  open: (page) => page.getByRole('tab', { name: 'Search', exact: true }).click(),
  leave: (page) => page.getByRole('tab', { name: 'Robot', exact: true }).click(),
  table: 'searches',
  rest: /All 200 searches/,
};

// Milliseconds from the key or click to the frame that shows the whole list.
async function opening(page: Page, list: List): Promise<number> {
  await page.evaluate(([table, rest, longest]) => {
    const scope = window as unknown as { opened: Promise<number> };
    scope.opened = new Promise((resolve, reject) => {
      let begin: number | null = null;
      const note = (event: Event) => (begin ??= event.timeStamp);
      for (const name of ['keydown', 'click']) addEventListener(name, note, { capture: true, once: true });
      const isWhole = () => {
        const frame = document.querySelector(`[data-testid=${table}]`);
        const buttons = [...(frame?.closest('section')?.querySelectorAll('button') ?? [])];
        return buttons.some((button) => new RegExp(rest).test(button.textContent ?? ''));
      };
      const look = () => {
        if (begin !== null && isWhole()) requestAnimationFrame(() => resolve(performance.now() - (begin as number)));
        else requestAnimationFrame(look);
      };
      requestAnimationFrame(look);
      setTimeout(() => reject(new Error(`the list of ${table} is not whole`)), longest);
    });
  }, [list.table, list.rest.source, patience] as const);
  await list.open(page);
  return page.evaluate(() => (window as unknown as { opened: Promise<number> }).opened);
}

async function measure({ browser, log }: Bench, folder: string, scenario: string) {
  const first = { recordings: [] as number[], searches: [] as number[] };
  const again = { recordings: [] as number[], searches: [] as number[] };
  const memory: number[] = [];
  let resident = 0;
  for (let start = 0; start < starts; start += 1) {
    log(`start ${start + 1} of ${starts}`);
    const program = await UiProgram.start(scenario, ['--recordings', folder]);
    try {
      for (let number = 0; number < pages; number += 1) {
        const viewer = await Viewer.open(browser, program.address);
        const { page } = viewer;
        await page.waitForTimeout(starting);
        first.recordings.push(await opening(page, recordingList));
        await recordingList.leave(page);
        await searchList.leave(page);
        first.searches.push(await opening(page, searchList));
        if (start === starts - 1 && number === pages - 1) {
          await page.waitForTimeout(settling);
          const before = residentMemory(program.pid);
          for (let times = 0; times < openings; times += 1) {
            await searchList.leave(page);
            again.searches.push(await opening(page, searchList));
            again.recordings.push(await opening(page, recordingList));
            await recordingList.leave(page);
          }
          await page.waitForTimeout(settling);
          resident = residentMemory(program.pid) / 1024;
          memory.push(resident - before / 1024);
        }
        await viewer.close();
      }
    } finally {
      await program.end();
    }
  }
  return { first, again, memory, resident };
}

export const week: Measurement = async (bench) => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-week-'));
  try {
    bench.log(`making ${searches} searches and ${recordings} recordings`);
    const { first, again, memory, resident } = await measure(bench, folder, makeWeek(folder));
    const begins = `from the key or click to the frame with the whole list, in a page at rest; ${starts} starts of the program, ${pages} new pages each`;
    const returns = 'the same, in a page that has shown it before';
    const wanted = { p99: limit };
    return [
      { name: `list of ${recordings} recordings`, unit: 'ms', wanted, conditions: begins, samples: first.recordings },
      { name: `list of ${searches} searches`, unit: 'ms', wanted, conditions: begins, samples: first.searches },
      { name: `list of ${recordings} recordings, again`, unit: 'ms', wanted, conditions: returns, samples: again.recordings },
      { name: `list of ${searches} searches, again`, unit: 'ms', wanted, conditions: returns, samples: again.searches },
      { name: 'memory of the program, both lists open', unit: 'MiB', wanted: {}, conditions: 'resident', samples: [resident] },
      { name: 'memory of the program more by', unit: 'MiB', wanted: { median: 10 }, conditions: `both lists opened ${openings} times`, samples: memory },
    ];
  } finally {
    rmSync(folder, { recursive: true });
  }
};
