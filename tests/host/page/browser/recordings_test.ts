// Recordings in the page: what it shows is what `proleg export` writes; a growing file is followed; a damaged file is one line.
import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import type { Browser } from 'playwright-core';
import { countPixelsWhen, isBlue } from './support/pixels.js';
import { launchBrowser } from './support/browser.js';
import { Random } from '../support/random.js';
import { program, UiProgram, uniform } from './support/ui_program.js';
import { Viewer } from './support/viewer.js';
import { waitForFrames } from './support/waiting.js';

const seconds = 120;

// Columns of the table that `proleg export` writes.
function exported(file: string): Map<string, string[]> {
  const text = execFileSync(program, ['export', file, '--out', '-'], { encoding: 'utf8', maxBuffer: 1 << 28 });
  const [header, ...lines] = text.trimEnd().split('\n').map((line) => line.split('\t'));
  return new Map((header ?? []).map((name, column) => [name, lines.map((line) => line[column] ?? '')]));
}

class Recordings {
  constructor(readonly viewer: Viewer) {}

  get page() {
    return this.viewer.page;
  }

  // To where the pointer presses the time line.
  async press(share: number): Promise<void> {
    const box = await this.page.getByTestId('timeline').boundingBox();
    assert.ok(box);
    await this.page.mouse.click(box.x + 2 + (box.width - 4) * share, box.y + box.height / 2);
  }

  async tick(): Promise<number> {
    return this.viewer.tick();
  }

  // The numbers in the table of joints, when they are those of this tick.
  async waitForRow(column: string, expected: number[]): Promise<void> {
    const cells = `[data-testid=joints] td[data-value="${column}"]`;
    const texts = expected.map((value) => value.toFixed(1).replace(/^-0\.0$/, '0.0'));
    await this.page.waitForFunction(
      ([selector, wanted]) => [...document.querySelectorAll(selector)].map((cell) => cell.textContent).join() === wanted,
      [cells, texts.join()] as const,
    );
  }
}

describe('recordings', () => {
  let folder: string;
  let browser: Browser;
  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'proleg-page-'));
    const run = ['simulate', uniform, '--seconds', String(seconds), '--set', 'amplitude=30@1000', '--record'];
    execFileSync(program, [...run, join(folder, 'run.proleg')], { stdio: 'ignore' });
    writeFileSync(join(folder, 'broken.proleg'), 'no recording');
    browser = await launchBrowser();
  });
  after(async () => {
    await browser.close();
    rmSync(folder, { recursive: true });
  });

  it('shows at every tick what the file has', async () => {
    const table = exported(join(folder, 'run.proleg'));
    const joints = [...table.keys()].filter((name) => name.startsWith('angle_deg.')).map((name) => name.slice('angle_deg.'.length));
    const served = await UiProgram.serve([join(folder, 'run.proleg')]);
    try {
      const seed = Date.now();
      console.log(`seed ${seed}`);
      const random = new Random(seed);
      const recordings = new Recordings(await Viewer.open(browser, served.address));
      const { page } = recordings;
      const expectRow = async (tick: number) => {
        for (const [column, title] of [['angle_deg', 'angle'], ['setpoint_deg', 'set-point']] as const) {
          const values = joints.map((joint) => Number(table.get(`${column}.${joint}`)?.[tick]));
          await recordings.waitForRow(title, values);
        }
      };
      await expectRow(0);
      for (let seek = 0; seek < 12; seek += 1) {
        await recordings.press(random.next());
        await waitForFrames(page, 6); // until then it may show the tick before
        await expectRow(await recordings.tick());
      }
      // The keys: Home, End, a tick, a second.
      await page.keyboard.press('End');
      await expectRow(seconds * 100 - 1);
      await page.keyboard.press('Home');
      await page.keyboard.press('ArrowRight');
      await page.keyboard.press('Shift+ArrowRight');
      await page.waitForFunction(() => document.querySelector('[data-testid=tick]')?.textContent === '101');
      await expectRow(101);
      assert.ok((await countPixelsWhen(page, page.getByTestId('scene'), isBlue, (count) => count > 500)) > 500);
      await recordings.viewer.screenshot('recording');
      await recordings.viewer.close();
    } finally {
      await served.end();
    }
  });

  it('plays at the speed that is chosen, and stops at the end', async () => {
    const served = await UiProgram.serve([join(folder, 'run.proleg')]);
    try {
      const recordings = new Recordings(await Viewer.open(browser, served.address));
      const { page } = recordings;
      await page.keyboard.press('End');
      await page.keyboard.press('Shift+ArrowLeft');
      await page.getByLabel('Speed').selectOption('10');
      await page.getByTestId('timeline').focus();
      await page.keyboard.press('k');
      await recordings.viewer.button('Play').waitFor();
      await page.waitForFunction((last) => document.querySelector('[data-testid=tick]')?.textContent === last, String(seconds * 100 - 1));
      await recordings.viewer.close();
    } finally {
      await served.end();
    }
  });

  it('saves what is shown as a table and as pictures', async () => {
    const table = exported(join(folder, 'run.proleg'));
    const served = await UiProgram.serve([join(folder, 'run.proleg')]);
    try {
      const viewer = await Viewer.open(browser, served.address);
      const { page } = viewer;
      await page.locator('.strip-panel select:visible').selectOption('setpoint');
      // The part about 30 s.
      await new Recordings(viewer).press(0.25);
      const strip = await page.getByTestId('strip').boundingBox();
      assert.ok(strip);
      await page.mouse.move(strip.x + strip.width * 0.3, strip.y + 20);
      await page.mouse.wheel(0, -1200);
      await page.getByRole('button', { name: 'Whole run' }).waitFor();
      const saved = async (button: string) => {
        const download = page.waitForEvent('download');
        await viewer.button(button).click();
        const file = await download;
        return { name: file.suggestedFilename(), bytes: readFileSync(await file.path()) };
      };
      const tsv = await saved('Table (TSV)');
      assert.equal(tsv.name, 'run.tsv');
      const [header = '', ...lines] = tsv.bytes.toString().trimEnd().split('\n');
      const names = header.split('\t');
      assert.deepEqual(names.slice(0, 2), ['tick', 'time_s']);
      assert.equal(names.filter((name) => name.startsWith('setpoint_deg.')).length, 5);
      assert.ok(lines.length > 100 && lines.length < 11000, `${lines.length} lines`);
      const first = Number(lines[0]?.split('\t')[0]);
      lines.forEach((line, i) => {
        line.split('\t').forEach((text, column) => {
          const name = names[column] as string;
          const expected = Number(table.get(name)?.[first + i]);
          // An angle is a double in the file and has 2^-30 of 90 degrees here.
          const error = Math.abs(Number(text) - expected);
          assert.ok(error <= 1e-7, `${name} in tick ${first + i}: found ${text}, expected ${expected}`);
        });
      });
      for (const panel of ['3D view', 'strip', 'plots', 'x over y']) {
        const png = await saved(panel);
        assert.match(png.name, /^run-.*\.png$/);
        assert.deepEqual([...png.bytes.subarray(0, 4)], [0x89, 0x50, 0x4e, 0x47]);
        const colours = await page.evaluate(async (image) => {
          const bytes = Uint8Array.from(atob(image), (character) => character.charCodeAt(0));
          const bitmap = await createImageBitmap(new Blob([bytes], { type: 'image/png' }));
          const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
          const context = canvas.getContext('2d') as OffscreenCanvasRenderingContext2D;
          context.drawImage(bitmap, 0, 0);
          return new Set(new Uint32Array(context.getImageData(0, 30, bitmap.width, bitmap.height - 30).data.buffer)).size;
        }, png.bytes.toString('base64'));
        assert.ok(colours > 10, `${png.name} has ${colours} colours`);
        writeFileSync(`build/page_test/${png.name}`, png.bytes);
      }
      await page.getByTestId('xy').scrollIntoViewIfNeeded();
      await viewer.screenshot('recording_export');
      await viewer.close();
    } finally {
      await served.end();
    }
  });

  it('lists a folder, says what is wrong with a file, and goes on', async () => {
    const served = await UiProgram.serve([folder]);
    try {
      const viewer = await Viewer.openList(browser, served.address);
      const { page } = viewer;
      const row = (name: string) => page.getByTestId('recordings').locator('tr').filter({ hasText: name });
      await row('run.proleg').getByText('2:00 min').waitFor();
      await row('run.proleg').getByText('uniform.simulation.xml').waitFor();
      await row('broken.proleg').getByText(/expected a recording/).waitFor();
      await viewer.screenshot('recordings');
      await viewer.button('broken.proleg').click();
      await page.getByRole('alert').getByText(/broken\.proleg.*expected a recording/).waitFor();
      // With keys alone: the file, and back.
      await viewer.button('run.proleg').focus();
      await page.keyboard.press('Enter');
      await page.getByTestId('opened').getByText('run.proleg').waitFor();
      await page.getByTestId('joints').locator('tbody tr').first().waitFor();
      await page.keyboard.press('Backspace');
      await row('run.proleg').waitFor();
      await viewer.close();
    } finally {
      await served.end();
    }
  });

  it('follows a file into which another program writes', async () => {
    const file = join(folder, 'growing.proleg');
    const simulation = spawn(program, ['simulate', uniform, '--seconds', '600', '--record', file], { stdio: 'ignore' });
    const ended = new Promise((resolve) => simulation.once('exit', resolve));
    const served = await UiProgram.serve([folder]);
    try {
      const viewer = await Viewer.openList(browser, served.address);
      const { page } = viewer;
      const row = page.getByTestId('recordings').locator('tr').filter({ hasText: 'growing.proleg' });
      await row.getByText(/ s$| min$/).waitFor();
      await viewer.button('growing.proleg').click();
      await page.getByTestId('growing').waitFor();
      const tick = await viewer.tick();
      await viewer.waitForTick(tick + 100);
      // Back in time it stays where it is.
      await page.keyboard.press('Home');
      await page.waitForFunction(() => document.querySelector('[data-testid=tick]')?.textContent === '0');
      simulation.kill('SIGKILL');
      await ended;
      await viewer.close();
    } finally {
      simulation.kill('SIGKILL');
      await ended;
      await served.end();
    }
    assert.ok(existsSync(file));
  });

  it('is a page beside a live robot, which goes on', async () => {
    const robot = await UiProgram.start(uniform, ['--recordings', folder]);
    try {
      const viewer = await Viewer.open(browser, robot.address);
      const { page } = viewer;
      await viewer.takeControl();
      await viewer.run();
      await page.keyboard.press('2');
      await viewer.button('run.proleg').click();
      await page.getByTestId('opened').waitFor();
      await page.keyboard.press('1');
      await page.locator('.live:not(.recorded) [data-testid=scene]').waitFor();
      const ticks = page.locator('.live:not(.recorded) [data-testid=tick]');
      const tick = Number(await ticks.textContent());
      await page.waitForFunction(
        (least) => Number(document.querySelector('.live:not(.recorded) [data-testid=tick]')?.textContent) > least,
        tick + 50,
      );
      // STOP works from the page Recordings, too, and Space is STOP there.
      await page.keyboard.press('2');
      await page.getByTestId('opened').waitFor();
      await page.keyboard.press('Space');
      assert.match(await viewer.stopReport(/stopped/), /^stopped in /);
      await viewer.waitForState('STOPPED');
      await viewer.close();
    } finally {
      await robot.end();
    }
  });
});
