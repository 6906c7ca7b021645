// Waits for what happens, never for a time. The end is only for a test that fails: a computer that has other work to do may be
// ten times as slow as an idle one.
import type { Page } from 'playwright-core';

export const longest = 300_000; // milliseconds

// Asks until it holds. False: it did not, to the end.
export async function waitUntil(holds: () => boolean | Promise<boolean>): Promise<boolean> {
  const pause = 20; // milliseconds
  for (const end = performance.now() + longest; !(await holds()); ) {
    if (performance.now() > end) return false;
    await new Promise((resolve) => setTimeout(resolve, pause));
  }
  return true;
}

// Until the page has drawn this often.
export async function waitForFrames(page: Page, count: number): Promise<void> {
  await page.evaluate(async (frames) => {
    for (let i = 0; i < frames; i += 1) await new Promise((resolve) => requestAnimationFrame(resolve));
  }, count);
}
