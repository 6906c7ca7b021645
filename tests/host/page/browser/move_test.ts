// A paused robot is moved by hand, and the command line repeats the run.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { after, before, describe, it } from 'node:test';
import type { Browser } from 'playwright-core';
import { launchBrowser } from './support/browser.js';
import { countDifferences, isBlue, pixelsOf } from './support/pixels.js';
import { program as proleg, UiProgram } from './support/ui_program.js';
import { Viewer } from './support/viewer.js';

describe('moving the robot', () => {
  let browser: Browser;
  let program: UiProgram;
  let viewer: Viewer;

  before(async () => {
    browser = await launchBrowser();
    program = await UiProgram.start();
    viewer = await Viewer.open(browser, program.address);
    await viewer.takeControl();
  });

  after(async () => {
    await viewer.close();
    await program.end();
    await browser.close();
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

  it('is in the command of the page', async () => {
    await viewer.run();
    await viewer.waitForTick((await viewer.tick()) + 80);
    await pause();
    await viewer.button('Command line').click();
    const command = viewer.page.getByTestId('command');
    await command.filter({ hasText: '--move' }).waitFor();
    const words = ((await command.textContent()) ?? '').split(' ').slice(1);
    await viewer.button('Close').click();
    assert.equal(words.filter((word) => word === '--move').length, 2);
    const simulated = execFileSync(proleg, [...words, '--json'], { encoding: 'utf8' });
    const { simulated_s } = JSON.parse(simulated) as { simulated_s: number };
    await viewer.waitForTick(Math.round(simulated_s * 100));
    assert.equal(await viewer.tick(), Math.round(simulated_s * 100));
  });
});
