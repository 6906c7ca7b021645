// From the user's hand to the robot: a slider, STOP.
import { sixty, uniform, type UiProgram } from '../browser/support/ui_program.js';
import type { Viewer } from '../browser/support/viewer.js';
import { probe, withLivePage, type Measurement } from './bench.js';
import { inTime, sleep } from './processes.js';
import { RawViewer } from './raw_viewer.js';
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

// When the server tells others what has happened to the robot: a program that looks on, beside the browser, notes it.
class Onlooker {
  readonly times: number[] = []; // milliseconds since 1970
  private arrived: () => void = () => {};

  constructor(
    private readonly raw: RawViewer,
    isEffect: (message: any) => boolean,
  ) {
    raw.onText = (message) => {
      if (!isEffect(message)) return;
      this.times.push(performance.timeOrigin + performance.now());
      this.arrived();
    };
  }

  async waitFor(count: number): Promise<void> {
    this.raw.send({ type: 'beat', age_ms: 0 }); // the server closes silent connections
    while (this.times.length < count) {
      await inTime(new Promise<void>((resolve) => (this.arrived = resolve)), 'what a key does');
    }
  }

  end(): void {
    this.raw.close();
  }
}

interface Delays {
  robot: number[]; // from the key to the robot
  screen: number[]; // and until the page has its effect
}

function delays(onlooker: Onlooker, keys: number[], screen: number[]): Delays {
  onlooker.end();
  return { robot: keys.map((time, i) => (onlooker.times[i] as number) - time), screen };
}

async function sliderDelays(viewer: Viewer, program: UiProgram): Promise<Delays> {
  await viewer.page.evaluate(() => (window.figures.watches_setpoints = true));
  const slider = viewer.parameter('1.offset').getByRole('slider').first();
  await slider.focus();
  const wantedOffset = ({ value }: any) => value.find((parameter: any) => parameter.slot === 1 && parameter.name === 'offset').wanted[0];
  const isParameters = ({ type, name }: any) => type === 'document' && name === 'parameters';
  const raw = await RawViewer.open(program.address);
  let present = wantedOffset(await raw.next(isParameters)); // what the first joint has, or gets with the next tick
  const onlooker = new Onlooker(raw, (message) => {
    const before = present;
    present = isParameters(message) ? wantedOffset(message) : before;
    return present !== before;
  });
  for (let i = 0; i < changes; i += 1) {
    await waitForEffect(viewer, 'quiet_rows', quietRows);
    await sleep(i % 10); // all phases of a tick
    await viewer.page.keyboard.press(i % 2 === 0 ? 'ArrowRight' : 'ArrowLeft');
    await onlooker.waitFor(i + 1);
    await waitForEffect(viewer, 'changes', i + 1);
  }
  const noted = await probe(viewer.page);
  return delays(onlooker, noted.slider_keys, noted.changes);
}

async function stopDelays(viewer: Viewer, program: UiProgram): Promise<Delays> {
  const isStopped = ({ type, text }: any) => type === 'notice' && text.startsWith('stopped by');
  const onlooker = new Onlooker(await RawViewer.open(program.address), isStopped);
  for (let i = 0; i < stops; i += 1) {
    await sleep(100 + (i % 10));
    await viewer.page.keyboard.press('Space');
    await onlooker.waitFor(i + 1);
    await waitForEffect(viewer, 'stops', i + 1);
    await viewer.waitForState('STOPPED');
    await viewer.run();
  }
  const noted = await probe(viewer.page);
  return delays(onlooker, noted.stop_keys, noted.stops);
}

export const sliderToSetpoint: Measurement = async (bench) => {
  const figures: Figure[] = [];
  for (const { file, joints, still } of robots) {
    const { robot, screen } = await withLivePage(bench, file, sliderDelays, still);
    figures.push(
      {
        name: `slider to commit, ${joints} joints`,
        unit: 'ms',
        wanted: { median: 15, p99: 30 },
        conditions: '3D on; from the key until another program has the news that the next tick of the simulation has the value',
        samples: robot,
      },
      {
        name: `slider to set-point in the page, ${joints} joints`,
        unit: 'ms',
        wanted: {},
        conditions: '3D on; from the key to the first row with another set-point in the page, with the wait for the tick (0 to 10 ms)',
        samples: screen,
      },
    );
  }
  return figures;
};

export const stopToStopped: Measurement = async (bench) => {
  const figures: Figure[] = [];
  for (const { file, joints } of robots) {
    const { robot, screen } = await withLivePage(bench, file, stopDelays);
    figures.push(
      {
        name: `STOP to all stopped, ${joints} joints`,
        unit: 'ms',
        wanted: { p99: 25 },
        conditions: '3D on; from the key Space until another program has the news that all joints have stopped',
        samples: robot,
      },
      {
        name: `STOP to the answer in the page, ${joints} joints`,
        unit: 'ms',
        wanted: {},
        conditions: '3D on; from the key Space to the answer in the page that all joints have stopped',
        samples: screen,
      },
    );
  }
  return figures;
};
