// The 3D view at 60 joints, drawn in software, and what it costs the main thread.
import type { Page } from 'playwright-core';
import { sixty } from '../browser/support/ui_program.js';
import { probe, withLivePage, type Measurement } from './bench.js';
import { sleep } from './processes.js';

const seconds = 30;
const settling = 5000; // milliseconds: the view chooses its resolution

// Times of the frames in which the 3D view drew something.
export async function countFrames(page: Page): Promise<() => Promise<number[]>> {
  const worker = page.workers().find((candidate) => candidate.url().includes('scene_worker'));
  if (worker === undefined) {
    throw new Error('found no worker of the 3D view, expected one');
  }
  await worker.evaluate(() => {
    const scope = self as unknown as { frames: number[]; requestAnimationFrame(callback: FrameRequestCallback): number };
    scope.frames = [];
    let hasDrawn = false;
    const { drawElementsInstanced } = WebGL2RenderingContext.prototype;
    WebGL2RenderingContext.prototype.drawElementsInstanced = function (...parameters) {
      hasDrawn = true;
      drawElementsInstanced.apply(this, parameters);
    };
    const request = scope.requestAnimationFrame.bind(self);
    scope.requestAnimationFrame = (callback) =>
      request((time) => {
        hasDrawn = false;
        callback(time);
        if (hasDrawn) scope.frames.push(performance.now());
      });
  });
  return () => worker.evaluate(() => (self as unknown as { frames: number[] }).frames);
}

export const drawing: Measurement = async (bench) =>
  withLivePage(bench, sixty, async ({ page }) => {
    const frames = await countFrames(page);
    await sleep(settling);
    const first = (await frames()).length;
    const tasks = (await probe(page)).long_tasks.length;
    await sleep(seconds * 1000);
    const times = (await frames()).slice(first);
    const longTasks = (await probe(page)).long_tasks.slice(tasks);
    const conditions = `a robot that moves, page of 1400 x 900, WebGL in software, ${seconds} s`;
    const start = times[0] as number;
    const perSecond = Array.from({ length: seconds - 1 }, (_, i) => {
      const from = start + 1000 * i;
      return times.filter((time) => time >= from && time < from + 1000).length;
    });
    return [
      { name: '3D frames, 60 joints', unit: '1/s', wanted: { median: 30, least: true }, conditions, samples: perSecond },
      {
        name: 'time between 3D frames, 60 joints',
        unit: 'ms',
        wanted: {},
        conditions,
        samples: times.slice(1).map((time, i) => time - (times[i] as number)),
      },
      { name: 'long tasks over 50 ms while live, 60 joints', unit: 'tasks', wanted: { p99: 0 }, conditions, samples: [longTasks.length] },
      {
        name: 'longest task over 50 ms while live, 60 joints',
        unit: 'ms',
        wanted: {},
        conditions: `${conditions}; 0: none`,
        samples: [Math.max(0, ...longTasks)],
      },
    ];
  });
