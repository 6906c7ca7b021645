// A paused robot is moved by hand. The recording has it, and the command of the page repeats it.
import assert from 'node:assert/strict';
import { mkdtempSync, readdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import type { Browser } from 'playwright-core';
import { launchBrowser } from './support/browser.js';
import { resultOf, shownCommand } from './support/command_line.js';
import { countDifferences, isBlue, pixelsOf } from './support/pixels.js';
import { UiProgram, uniform } from './support/ui_program.js';
import { Viewer } from './support/viewer.js';

describe('moving the robot', () => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-page-'));
  let browser: Browser;
  let program: UiProgram;
  let viewer: Viewer;

  before(async () => {
    browser = await launchBrowser();
    program = await UiProgram.start(uniform, ['--recordings', folder]);
    viewer = await Viewer.open(browser, program.address);
    await viewer.takeControl();
  });

  after(async () => {
    await viewer.close();
    await program.end();
    await browser.close();
    rmSync(folder, { recursive: true });
  });

  const pause = async () => {
    await viewer.button('Pause').click();
    await viewer.waitForState('paused');
  };
  // Waits until the head is elsewhere, and returns where.
  const headOtherThan = async (before: readonly number[]) => {
    await viewer.page.waitForFunction(
      (old) => {
        const numbers = [...(document.querySelector('[data-testid=head]')?.textContent ?? '').matchAll(/-?\d+\.\d+/g)].map(Number);
        return numbers.length === 3 && numbers.some((value, i) => Math.abs(value - (old[i] as number)) > 0.004);
      },
      [...before],
    );
    return viewer.head();
  };
  // The middle of the blue pixels of the 3D view, on the page.
  const middleOfRobot = async () => {
    const scene = viewer.page.getByTestId('scene');
    const box = await scene.boundingBox();
    const { data, width, height } = await pixelsOf(viewer.page, scene);
    const blue: [number, number][] = [];
    for (let i = 0; i < width * height; i += 1) {
      if (isBlue(data[4 * i] as number, data[4 * i + 1] as number, data[4 * i + 2] as number)) blue.push([i % width, Math.floor(i / width)]);
    }
    assert.ok(blue.length > 100, 'the robot is in the picture');
    // A pixel of the robot: the one nearest to the mean.
    const mean = [0, 1].map((axis) => blue.reduce((sum, at) => sum + (at[axis] as number), 0) / blue.length);
    blue.sort((a, b) => Math.hypot(a[0] - mean[0]!, a[1] - mean[1]!) - Math.hypot(b[0] - mean[0]!, b[1] - mean[1]!));
    const [x, y] = blue[0] as [number, number];
    return { x: (box?.x ?? 0) + x, y: (box?.y ?? 0) + y };
  };

  it('is not possible while it runs', async () => {
    await viewer.run();
    await viewer.waitForTick(60);
    assert.equal(await viewer.button('Move').isDisabled(), true);
    await pause();
    assert.equal(await viewer.button('Move').isEnabled(), true);
  });

  it('follows a drag over the ground, and keeps the height', async () => {
    await viewer.button('Move').click();
    const before = await viewer.head();
    const picture = await pixelsOf(viewer.page, viewer.page.getByTestId('scene'));
    const { x, y } = await middleOfRobot();
    await viewer.page.mouse.move(x, y);
    await viewer.page.mouse.down();
    for (let step = 1; step <= 8; step += 1) await viewer.page.mouse.move(x + 12 * step, y + 2 * step);
    await headOtherThan(before);
    await viewer.page.mouse.up();
    await viewer.screenshot('move');
    const after = await headOtherThan(before);
    assert.ok(Math.abs(after[2] - before[2]) < 0.002, `the height ${before[2]} m is now ${after[2]} m`);
    assert.ok(countDifferences(picture, await pixelsOf(viewer.page, viewer.page.getByTestId('scene'))) > 200);
  });

  it('goes to a typed place, and refuses one without ground', async () => {
    const form = viewer.page.getByRole('form', { name: 'Place of the head' });
    const typePlace = async (place: Record<string, string>) => {
      for (const [name, value] of Object.entries(place)) await form.locator(`[name="${name}"]`).fill(value);
      await form.getByRole('button', { name: 'Put there' }).click();
    };
    const before = await viewer.head();
    await typePlace({ x: '0,4', y: '-0.3', z: '0.1', turn: '45' });
    await headOtherThan(before);
    assert.deepEqual(await viewer.head(), [0.4, -0.3, 0.1]);
    await typePlace({ x: '900', y: '0', z: '0', turn: '0' });
    await viewer.page.getByText(/found nothing below the robot/).first().waitFor();
    assert.deepEqual(await viewer.head(), [0.4, -0.3, 0.1]);
  });

  it('is recorded, and repeated by the command of the page', async () => {
    await viewer.button('Record').click();
    await viewer.button('Recording').waitFor();
    await viewer.run();
    await viewer.waitForTick((await viewer.tick()) + 80);
    await pause();
    const command = await shownCommand(viewer);
    await viewer.button('Recording').click();
    await viewer.button('Record').waitFor();
    assert.equal(command.match(/--move /g)?.length, 2, command);
    const [file] = readdirSync(folder);
    const replayed = resultOf(`proleg replay ${join(folder, file as string)}`);
    assert.equal(replayed['differences'], 0);
    assert.equal(replayed['verified'], true);
    const repeated = resultOf(command);
    assert.equal(repeated['servo_hash'], replayed['recorded_servo_hash']);
    // The hash is of what the joints are told; the measures are of what the robot does.
    const speed = (result: Record<string, unknown>) => `${((result['measures'] as { speed: number }).speed * 1000).toFixed(1)} mm/s`;
    await viewer.page.locator('dl', { hasText: 'gait' }).getByText(speed(repeated)).waitFor();
    assert.notEqual(speed(resultOf(command.replace(/ --move \S+/g, ''))), speed(repeated));
  });
});
