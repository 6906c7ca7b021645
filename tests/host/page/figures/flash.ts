// Whether the modules of a robot get a new program through the page as fast as by `proleg flash` in a shell.
import { execFileSync } from 'node:child_process';
import { cpSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { BusProgram } from '../browser/support/bus_program.js';
import { program as proleg, UiProgram } from '../browser/support/ui_program.js';
import { Viewer } from '../browser/support/viewer.js';
import type { Bench, Measurement } from './bench.js';

const pairs = 4;
const slot = 0x08020200; // where the program of a module begins
const words = 20_000; // of 4 bytes: as large as the image of the firmware
const limit = 1.1; // of the ratio: as fast, but for what a busy computer does

// A project with an image whose body looks like a program.
function makeProject(): string {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-figures-'));
  cpSync('sim/scenarios/travelling_wave', folder, { recursive: true });
  const body = new Uint32Array(words).map((_, i) => (i === 0 ? 0x20000800 : i === 1 ? slot + 0x201 : Math.imul(i, 2654435761)));
  const raw = join(folder, 'body.bin');
  writeFileSync(raw, new Uint8Array(body.buffer));
  const image = ['--board', '1', '--address', `0x${slot.toString(16)}`, '--version', '0.2.0', '--protocol', '0x0100', '--fingerprint', '12345678', '--schema', '2'];
  execFileSync(proleg, ['image', 'make', raw, '--output', join(folder, 'new.pimg'), ...image], { stdio: 'ignore' });
  return folder;
}

// New modules for each: they have not got the image before.
async function withBus<T>(use: (address: string) => Promise<T>): Promise<T> {
  const bus = await BusProgram.start();
  try {
    return await use(bus.address);
  } finally {
    await bus.end();
  }
}

function flashInShell(folder: string): Promise<number> {
  return withBus(async (address) => {
    const begin = performance.now();
    execFileSync(proleg, ['flash', join(folder, 'new.pimg'), '--canary', '--bus', address], { stdio: 'ignore' });
    return performance.now() - begin;
  });
}

// From the click to the end of the job, as the page shows it.
function flashInPage({ browser }: Bench, folder: string): Promise<number> {
  return withBus(async (address) => {
    const program = await UiProgram.start(join(folder, 'uniform.simulation.xml'), ['--recordings', folder]);
    try {
      const viewer = await Viewer.open(browser, program.address);
      const { page } = viewer;
      await viewer.takeControl();
      await page.getByRole('button', { name: 'Modules', exact: true }).click();
      await page.getByLabel('another address').fill(address);
      await page.getByRole('button', { name: 'Open', exact: true }).click();
      await page.getByTestId('bus-state').getByText('open').waitFor();
      await page.getByTestId('modules').locator('tbody tr').nth(4).waitFor();
      await page.getByTestId('job-state').getByText('done').waitFor(); // of the scan
      await page.getByRole('tab', { name: 'Flash', exact: true }).click();
      const flash = page.getByRole('button', { name: 'Flash all modules' });
      await flash.and(page.locator(':enabled')).waitFor();
      const begin = performance.now();
      await flash.click();
      await page.getByTestId('verdicts').getByText('✓ runs the image').nth(4).waitFor();
      await page.getByTestId('job-state').getByText('done').waitFor();
      const taken = performance.now() - begin;
      await viewer.close();
      return taken;
    } finally {
      await program.end();
    }
  });
}

export const flash: Measurement = async (bench) => {
  const folder = makeProject();
  try {
    const inShell: number[] = [];
    const inPage: number[] = [];
    for (let pair = 0; pair < pairs; pair += 1) {
      // In both orders.
      if (pair % 2 === 0) inShell.push(await flashInShell(folder));
      inPage.push(await flashInPage(bench, folder));
      if (pair % 2 === 1) inShell.push(await flashInShell(folder));
      bench.log(`pair ${pair + 1} of ${pairs}: ${((inShell.at(-1) as number) / 1000).toFixed(1)} s in a shell, ${((inPage.at(-1) as number) / 1000).toFixed(1)} s in the page`);
    }
    const conditions = `five native modules of proleg bus, ${(4 * words) / 1000} kB, one module first; new modules for each`;
    return [
      {
        name: 'flash through the page against a shell',
        unit: 'times as long',
        wanted: { median: limit },
        conditions,
        samples: inPage.map((taken, i) => taken / (inShell[i] as number)),
      },
      { name: 'flash in a shell', unit: 's', wanted: {}, conditions, samples: inShell.map((taken) => taken / 1000) },
    ];
  } finally {
    rmSync(folder, { recursive: true });
  }
};
