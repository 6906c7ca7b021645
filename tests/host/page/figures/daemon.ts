// What the page's server costs beside the simulation, and what a viewer costs that does not read.
import { spawn } from 'node:child_process';
import { program as proleg, sixty, uniform, UiProgram } from '../browser/support/ui_program.js';
import { periods, withLivePage, type Measurement } from './bench.js';
import { inTime, residentMemory, sleep, sum, threadTimes, unsentBytes } from './processes.js';
import { RawViewer } from './raw_viewer.js';

const simulatedSeconds = 120;
const windows = 20;
const windowSeconds = 2;

// `proleg simulate` on the same robot: processor time for a second of the robot, in milliseconds, and memory in KiB.
async function simulate(file: string): Promise<{ cpu: number; memory: number }> {
  const child = spawn(proleg, ['simulate', file, '--seconds', String(simulatedSeconds)], { stdio: 'ignore' });
  const pid = child.pid as number;
  let cpu = 0;
  let memory = 0;
  const status = await new Promise<number | null>((resolve, reject) => {
    const poll = setInterval(() => {
      try {
        cpu = sum(threadTimes(pid));
        memory = residentMemory(pid, 'VmHWM');
      } catch {
        // It has ended since.
      }
    }, 2);
    child.on('error', reject);
    child.on('exit', (code) => {
      clearInterval(poll);
      resolve(code);
    });
  });
  if (status !== 0 || cpu === 0) {
    throw new Error(`proleg simulate ${file}: found exit status ${status}, expected 0`);
  }
  return { cpu: cpu / simulatedSeconds, memory };
}

export const besideSimulation: Measurement = async (bench) => {
  const alone = await simulate(uniform);
  return withLivePage(bench, uniform, async (_, { pid }) => {
    await sleep(2000);
    const parts = await periods(windows, windowSeconds * 1000, async () => threadTimes(pid));
    const conditions = `5 joints in real time, one page; ${windowSeconds} s each`;
    const share = (times: { before: number; after: number; ms: number }) => (100 * (times.after - times.before)) / times.ms;
    return [
      {
        name: 'daemon beside the simulation, processor',
        unit: '% of a core',
        wanted: { median: 3 },
        conditions: `${conditions}; less what proleg simulate needs for as many ticks in one go (${(alone.cpu / 10).toFixed(2)} %)`,
        samples: parts.map(({ before, after, ms }) => share({ before: sum(before), after: sum(after), ms }) - alone.cpu / 10),
      },
      {
        name: 'daemon beside the simulation, the server\'s thread alone',
        unit: '% of a core',
        wanted: {},
        conditions,
        samples: parts.map(({ before, after, ms }) => share({ before: before[0] as number, after: after[0] as number, ms })),
      },
      {
        name: 'daemon beside the simulation, memory',
        unit: 'MiB',
        wanted: { median: 30 },
        conditions: 'resident, less the largest of proleg simulate',
        samples: [(residentMemory(pid) - alone.memory) / 1024],
      },
    ];
  });
};

const ticks = 1000; // of one run, the same ticks each time
const pairs = 15;

// Milliseconds, and processor time of the simulation's thread, for the ticks from 0 on.
async function timeRun(driver: RawViewer, epoch: number, pid: number): Promise<{ ms: number; cpu: number }> {
  await driver.operate('restart', {}, epoch);
  const simulation = () => sum(threadTimes(pid).slice(1));
  const done = new Promise<void>((resolve) => {
    driver.onTelemetry = ({ tick, rows }) => {
      if (tick + rows >= ticks) resolve();
    };
  });
  const cpu = simulation();
  const begin = performance.now();
  await driver.operate('step', { ticks }, epoch);
  await inTime(done, `${ticks} ticks`);
  return { ms: performance.now() - begin, cpu: simulation() - cpu };
}

// A viewer that wants everything, and reads nothing until neither the kernel nor the server can send more.
async function openStalled(address: string, signals: string[], advance: () => Promise<unknown>): Promise<RawViewer> {
  const viewer = await RawViewer.open(address);
  viewer.stall();
  viewer.send({ type: 'subscribe', signals });
  for (let before = -1, rounds = 0; rounds < 200; rounds += 1) {
    await advance();
    const unsent = unsentBytes(viewer.serverPort, viewer.port);
    if (unsent === before && unsent > 0) {
      return viewer;
    }
    before = unsent;
  }
  throw new Error('found a viewer that still gets data without reading, expected full buffers');
}

export const stalledViewer: Measurement = async (bench) => {
  const program = await UiProgram.start(sixty);
  try {
    const driver = await RawViewer.open(program.address);
    const signals = (await driver.signals()).map(({ name }) => name);
    const { epoch } = await driver.operate('control.take');
    // The driver must beat, or it counts as away; it still may drive.
    const beats = setInterval(() => driver.send({ type: 'beat', age_ms: 0 }), 250);
    driver.send({ type: 'subscribe', signals: ['head'] });
    const run = () => timeRun(driver, epoch, program.pid);
    await run();
    const memory: number[] = [];
    const speed: number[] = [];
    const cost: number[] = [];
    for (let pair = 0; pair < pairs; pair += 1) {
      bench.log(`stalled viewer, pair ${pair + 1} of ${pairs}`);
      // With and without, in both orders.
      const without = pair % 2 === 0 ? await run() : null;
      const before = residentMemory(program.pid);
      const viewer = await openStalled(program.address, signals, run);
      memory.push((residentMemory(program.pid) - before) / 1024);
      const stalled = await run();
      viewer.close();
      await sleep(200);
      const other = without ?? (await run());
      speed.push(100 * (stalled.ms / other.ms - 1));
      cost.push(100 * (stalled.cpu / other.cpu - 1));
    }
    clearInterval(beats);
    driver.close();
    const conditions = `the same ${ticks} ticks of 60 joints as fast as possible, with a viewer of all signals that reads nothing and without`;
    return [
      { name: 'stalled viewer: simulation longer by', unit: '%', wanted: { median: 1 }, conditions, samples: speed },
      { name: 'stalled viewer: processor time of the simulation more by', unit: '%', wanted: { median: 1 }, conditions, samples: cost },
      { name: 'stalled viewer: memory of the daemon', unit: 'MiB', wanted: {}, conditions: 'resident memory more by', samples: memory },
    ];
  } finally {
    await program.end();
  }
};
