// The machine that the figures belong to.
import { cpus, loadavg, release } from 'node:os';
import type { Browser } from 'playwright-core';

export interface Machine {
  processor: string;
  cores: number;
  kernel: string;
  chromium: string;
  load: number[]; // of the last 1, 5 and 15 minutes
}

export function describeMachine(browser: Browser): Machine {
  const processor = cpus()[0]?.model ?? 'unknown';
  return { processor, cores: cpus().length, kernel: release(), chromium: browser.version(), load: loadavg() };
}

export function machineText({ processor, cores, kernel, chromium, load }: Machine): string {
  const loads = load.map((value) => value.toFixed(1)).join(', ');
  return `${processor}, ${cores} cores, Linux ${kernel}, Chromium ${chromium}, WebGL in software; load average ${loads}`;
}
