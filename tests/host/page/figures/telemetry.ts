// Telemetry: what it costs the main thread, and how many bytes it has.
import { sixty, UiProgram } from '../browser/support/ui_program.js';
import type { Viewer } from '../browser/support/viewer.js';
import { periods, probe, withLivePage, type Measurement } from './bench.js';
import { inTime, sleep, sum } from './processes.js';
import { RawViewer } from './raw_viewer.js';

const wantedRate = 60000; // samples a second
const mostLines = 8; // of a plot
const seconds = 30;
const sceneSignals = ['angle', 'head', 'contact'];

// A line of each signal, so that the page subscribes to all of them.
async function plotAllSignals(viewer: Viewer, signals: string[]): Promise<void> {
  for (let from = 0; from < signals.length; from += mostLines) {
    await viewer.button('Add a plot').click();
    const group = viewer.page.locator('.line-group').last();
    for (const signal of signals.slice(from, from + mostLines)) {
      await group.getByLabel('Signal').selectOption(signal);
      await group.getByRole('group', { name: `Lines of ${signal}`, exact: true }).getByRole('button').first().click();
    }
  }
}

export const intake: Measurement = async (bench) =>
  withLivePage(bench, sixty, async (viewer, program) => {
    const { page } = viewer;
    const pageFrame = (await probe(page)).frame_bytes;
    const raw = await RawViewer.open(program.address);
    const signals = await raw.signals();
    raw.close();
    await plotAllSignals(viewer, signals.map(({ name }) => name));
    await sleep(2000);
    const parts = await periods(seconds, 1000, () => probe(page));
    const samples = parts.map(({ before, after }) => after.samples - before.samples);
    const rate = sum(samples) / (sum(parts.map(({ ms }) => ms)) / 1000);
    return [
      {
        name: 'main thread, for 60,000 samples/s',
        unit: '%',
        wanted: { p99: 3 },
        conditions: `decoding and storing all ${signals.length} signals of 60 joints in the page; ${Math.round(rate)} samples/s were there, shares are for ${wantedRate}`,
        samples: parts.map(({ before, after }, i) => (((after.handling_ms - before.handling_ms) / (samples[i] as number)) * wantedRate) / 10),
      },
      {
        name: 'frame of telemetry of the page, 60 joints',
        unit: 'bytes',
        wanted: {},
        conditions: 'one tick; with the signals of the 3D view, the strip, the first plot and the table of joints',
        samples: [pageFrame],
      },
    ];
  });

export const bytes: Measurement = async () => {
  const program = await UiProgram.start(sixty);
  try {
    const viewer = await RawViewer.open(program.address);
    const signals = await viewer.signals();
    const { epoch } = await viewer.operate('control.take');
    // The signals of the 3D view: one tick is one message.
    viewer.send({ type: 'subscribe', signals: sceneSignals });
    let frame = 0;
    const one = new Promise<void>((resolve) => {
      viewer.onTelemetry = ({ rows }) => {
        frame = viewer.bytes / rows;
        resolve();
      };
    });
    await viewer.operate('step', { ticks: 1 }, epoch);
    await inTime(one, 'a row of telemetry');
    viewer.onTelemetry = () => {};
    viewer.send({ type: 'subscribe', signals: signals.map(({ name }) => name) });
    await viewer.operate('run', {}, epoch);
    await sleep(1000);
    const parts = await periods(10, 1000, async () => viewer.bytes);
    viewer.close();
    return [
      {
        name: 'frame of telemetry for the 3D view, 60 joints',
        unit: 'bytes',
        wanted: { median: 550 },
        conditions: `one tick of ${sceneSignals.join(', ')}`,
        samples: [frame],
      },
      {
        name: `all ${signals.length} signals, 60 joints`,
        unit: 'kB/s',
        wanted: { median: 150 },
        conditions: `${sum(signals.map(({ count }) => count))} values of 4 bytes, 100 ticks/s`,
        samples: parts.map(({ before, after, ms }) => (after - before) / ms),
      },
    ];
  } finally {
    await program.end();
  }
};
