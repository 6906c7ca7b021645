// A recording as one file, opened from the folder: it plays without a server and without a network.
import assert from 'node:assert/strict';
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';
import type { Browser } from 'playwright-core';
import axe from 'axe-core';
import { launchBrowser } from './support/browser.js';
import { countDifferences, countPixelsWhen, isBlue, pixelsOf } from './support/pixels.js';
import { exportPage, record, tableOf } from './support/recorded.js';
import { uniform } from './support/ui_program.js';
import { Viewer } from './support/viewer.js';
import { waitUntil } from './support/waiting.js';

const reflex = 'sim/scenarios/obstacle/reflex.simulation.xml';
const hostile = `</script><script>document.title='owned'</script>`;
const joints = ['J5', 'J4', 'J3', 'J2', 'J1'];

// Addresses that a page has asked for, but for itself and the worker in it.
function watchRequests(viewer: Viewer, address: string): string[] {
  const requests: string[] = [];
  viewer.page.on('request', (request) => {
    if (request.url() !== address && !request.url().startsWith('blob:')) requests.push(request.url());
  });
  return requests;
}

// It plays as soon as it has been read, and on a busy computer it may have come to its end. A step pauses.
async function pause(viewer: Viewer): Promise<void> {
  assert.ok(await waitUntil(async () => (await viewer.tick()) > 0));
  await viewer.page.keyboard.press('ArrowLeft');
  await viewer.button('Play').waitFor();
}

// The page writes its tick with the next frame.
async function waitForTick(viewer: Viewer, least: number, most = least): Promise<void> {
  await viewer.page.waitForFunction(
    ([low, high]) => {
      const tick = Number(document.querySelector('[data-testid=tick]')?.textContent);
      return tick >= low && tick <= high;
    },
    [least, most] as const,
  );
}

// The table of joints is written some times a second.
async function expectAngles(viewer: Viewer, wanted: readonly number[]): Promise<void> {
  await viewer.page.waitForFunction((expected) => {
    const cells = [...document.querySelectorAll('[data-testid=joints] td[data-value=angle]')];
    return cells.every((cell, i) => Math.abs(Number(cell.textContent) - (expected[i] as number)) < 0.051);
  }, wanted);
}

async function expectHead(viewer: Viewer, wanted: readonly number[]): Promise<void> {
  await viewer.page.waitForFunction((expected) => {
    const text = document.querySelector('[data-testid=head]')?.textContent ?? '';
    const found = [...text.matchAll(/-?\d+\.\d+/g)].map(Number);
    return found.length === 3 && found.every((value, i) => Math.abs(value - (expected[i] as number)) < 0.001);
  }, wanted);
}

describe('the page of a recording', () => {
  let folder: string;
  let browser: Browser;
  let address: string;
  const recording = () => join(folder, 'reflex.proleg');

  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'proleg-player-'));
    record(recording(), reflex, '--seconds', '8', '--set', 'amplitude=30@400', '--set', '1.amplitude:J2=20@600');
    address = pathToFileURL(exportPage(recording())).href;
    browser = await launchBrowser();
  });

  after(async () => {
    await browser.close();
    rmSync(folder, { recursive: true });
  });

  it('plays in 3D without asking for another address', async () => {
    const viewer = await Viewer.open(browser, address);
    const requests = watchRequests(viewer, address);
    await viewer.page.reload();
    await pause(viewer);
    const scene = viewer.page.getByTestId('scene');
    // The first image takes longer than the first ticks.
    const isThere = (count: number) => count > 1000;
    assert.ok(isThere(await countPixelsWhen(viewer.page, scene, isBlue, isThere)), 'found no robot in the 3D view');
    const early = await pixelsOf(viewer.page, scene);
    await viewer.button('Play').click();
    await viewer.waitForTick(Math.min(799, (await viewer.tick()) + 60));
    const hasMoved = async () => countDifferences(early, await pixelsOf(viewer.page, scene)) > 1000;
    assert.ok(await waitUntil(hasMoved), 'found the same picture, expected a robot that moves');
    await viewer.screenshot('player');
    assert.deepEqual(requests, []);
    await viewer.close();
  });

  it('shows the joint angles of every tick that is scrubbed to', async () => {
    const table = tableOf(recording());
    const viewer = await Viewer.open(browser, address);
    await pause(viewer);
    const track = viewer.page.getByTestId('timeline');
    const box = await track.boundingBox();
    assert.ok(box);
    for (const share of [0.1, 0.5, 0.9]) {
      await viewer.page.mouse.click(box.x + share * box.width, box.y + box.height / 2);
      await waitForTick(viewer, share * 799 - 3, share * 799 + 3);
      const row = table[await viewer.tick()] as Record<string, number>;
      await expectAngles(viewer, joints.map((joint) => row[`angle_deg.${joint}`] as number));
      const head = ['x', 'y', 'z'].map((axis) => row[`${axis}_m.Head`] as number);
      await expectHead(viewer, head);
    }
    await viewer.close();
  });

  it('obeys the keys', async () => {
    const viewer = await Viewer.open(browser, address);
    await pause(viewer);
    const { keyboard } = viewer.page;
    const keys = [['Home', 0], ['ArrowRight', 1], ['ArrowRight', 2], ['Shift+ArrowRight', 102]] as const;
    const more = [['ArrowLeft', 101], ['Shift+ArrowLeft', 1], ['End', 799]] as const;
    for (const [key, tick] of [...keys, ...more]) {
      await keyboard.press(key);
      await waitForTick(viewer, tick);
    }
    // On the time line too, and once.
    await viewer.page.getByTestId('timeline').focus();
    await keyboard.press('ArrowLeft');
    await waitForTick(viewer, 798);
    await keyboard.press('Home');
    await keyboard.press('Space');
    await viewer.button('Pause').waitFor();
    await viewer.close();
  });

  it('marks the changes, and goes to them', async () => {
    const viewer = await Viewer.open(browser, address);
    await pause(viewer);
    const marks = viewer.page.getByTestId('marks').getByRole('button');
    assert.deepEqual(await marks.locator('.text').allTextContents(), ['amplitude = 30', 'amplitude J2 = 20']);
    await marks.nth(1).click();
    await waitForTick(viewer, 600);
    await viewer.close();
  });

  it('has no serious problem for those who use a keyboard or a screen reader, light and dark, wide and narrow', async () => {
    for (const [colorScheme, width] of [['light', 1400], ['dark', 420]] as const) {
      const viewer = await Viewer.open(browser, address, { colorScheme, viewport: { width, height: 900 } });
      await pause(viewer);
      await viewer.screenshot(`player_${colorScheme}_${width}`);
      // As an init script: the page lets no other script in.
      await viewer.page.addInitScript({ content: axe.source });
      await viewer.page.reload();
      await viewer.button('Pause').waitFor();
      const { violations } = await viewer.page.evaluate(() => (window as unknown as { axe: typeof axe }).axe.run());
      const serious = violations.filter(({ impact }) => impact === 'serious' || impact === 'critical');
      assert.deepEqual(serious.map(({ id, nodes }) => [id, nodes[0]?.html]), []);
      const overflow = await viewer.page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
      assert.ok(overflow <= 0, `found ${overflow} pixels beyond the window`);
      await viewer.close();
    }
  });

  it('shows names as text, whatever they are', async () => {
    const scenario = join(folder, 'hostile');
    cpSync('sim/scenarios/travelling_wave', scenario, { recursive: true });
    const robot = join(scenario, 'caterpillar.robot.xml');
    const name = hostile.replaceAll('<', '&lt;');
    writeFileSync(robot, readFileSync(robot, 'utf8').replace('<Joint name="J5"', `<Joint name="${name}"`));
    const file = join(folder, '<img src=x onerror=alert(1)>.proleg');
    record(file, join(scenario, uniform.split('/').at(-1) as string), '--seconds', '1');
    const viewer = await Viewer.open(browser, pathToFileURL(exportPage(file)).href);
    assert.equal(await viewer.page.title(), '<img src=x onerror=alert(1)>.proleg – Proleg');
    assert.equal(await viewer.page.getByTestId('joints').locator('tbody th').first().textContent(), hostile);
    assert.equal(await viewer.page.locator('img').count(), 0);
    await viewer.close();
  });

  it('lets no network in: a script in the page cannot load anything', async () => {
    const viewer = await Viewer.open(browser, address);
    const outcome = await viewer.page.evaluate(async () => {
      const failed = await fetch('http://127.0.0.1:9/').then(() => false, () => true);
      const script = document.createElement('script');
      script.textContent = 'window.wasRun = true';
      document.body.append(script);
      return { failed, wasRun: 'wasRun' in window };
    });
    assert.deepEqual(outcome, { failed: true, wasRun: false });
    viewer.expected.push(/Content Security Policy/);
    await viewer.close();
  });

  it('has the notices of the packages in it, as the player has', () => {
    const notices = (file: string) => /<!--\nContains code of these packages:\n.*preact [0-9.]+\n.*-->\n/s.exec(readFileSync(file, 'utf8'))?.[0];
    const page = fileURLToPath(address);
    assert.ok(notices(page) !== undefined);
    assert.equal(notices(page), notices('build/player/player.html'));
  });

  it('says so if the file is cut', async () => {
    const cut = join(folder, 'cut.html');
    const page = readFileSync(new URL(address), 'utf8');
    const start = page.indexOf('class="ticks">');
    writeFileSync(cut, page.slice(0, start + 5000) + page.slice(page.indexOf('</script>', start)));
    const viewer = await Viewer.open(browser, pathToFileURL(cut).href);
    await viewer.page.getByRole('alert').getByText('The file is damaged or not complete.').waitFor();
    await viewer.close();
  });
});
