// Eight hours of a live page, in less time: each message that the server sends is delivered many times.
import { uniform } from '../browser/support/ui_program.js';
import { withLivePage, type Bench, type Measurement } from './bench.js';
import { sleep } from './processes.js';

const hours = 8;
const settling = 60; // seconds until the rings of the history are allocated and full
const mebibyte = 1024 * 1024;

export const soak: Measurement = async (bench: Bench) => {
  const copies = Math.ceil((hours * 60) / bench.soakMinutes);
  return withLivePage(bench, uniform, async ({ page }) => {
    const session = await page.context().newCDPSession(page);
    const heap = async (): Promise<number> => {
      await session.send('HeapProfiler.collectGarbage');
      const usage = (await session.send('Runtime.getHeapUsage')) as { usedSize: number; embedderHeapUsedSize?: number; backingStorageSize?: number };
      return (usage.usedSize + (usage.embedderHeapUsedSize ?? 0) + (usage.backingStorageSize ?? 0)) / mebibyte;
    };
    await page.evaluate((count) => (window.figures.copies = count), copies);
    await sleep(settling * 1000);
    await page.evaluate(() => (window.figures.delivered_ticks = 0));
    const first = await heap();
    const heaps: number[] = [];
    for (let minute = 0; minute < bench.soakMinutes; minute += 0.25) {
      await sleep(15000);
      heaps.push((await heap()) - first);
      bench.log(`soak, ${minute + 0.25} of ${bench.soakMinutes} min: ${heaps.at(-1)?.toFixed(2)} MiB more`);
    }
    const ticks = await page.evaluate(() => window.figures.delivered_ticks);
    return [
      {
        name: 'growth of the heap in eight hours, accelerated',
        unit: 'MiB',
        wanted: { p99: 5 },
        conditions:
          `after collecting garbage, over ${bench.soakMinutes} min; main thread with its DOM and arrays. Accelerated: each message of the server ` +
          `(telemetry with its tick moved on, documents, signs of life) is delivered ${copies} times, ${(ticks / 360000).toFixed(1)} h of ticks. ` +
          'Not accelerated: frames drawn, the workers, the daemon',
        samples: heaps,
      },
    ];
  });
};
