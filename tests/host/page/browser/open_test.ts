// What can be opened in the page Make: a list with pictures of the project's scenarios, of those opened before, and of those that
// ship with Proleg.
import assert from 'node:assert/strict';
import { cpSync, existsSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import type { Browser, Page } from 'playwright-core';
import { seriousProblems } from './support/accessibility.js';
import { launchBrowser } from './support/browser.js';
import { assertNothingIsCut } from './support/layout.js';
import { countPixels, isBlue, pixelsOf } from './support/pixels.js';
import { useUi } from './support/ui_fixture.js';
import { UiProgram } from './support/ui_program.js';
import { Viewer } from './support/viewer.js';
import { waitUntil } from './support/waiting.js';

const isPath = (red: number, green: number, blue: number) => red > green + 50 && blue > green + 50;

const entriesIn = (page: Page, group: string) => page.getByTestId('open-panel').getByRole('region', { name: group, exact: true }).locator('.gallery-entry');

describe('the list of what can be opened', () => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-page-'));
  cpSync('sim/scenarios/travelling_wave', join(folder, 'mine'), { recursive: true });
  mkdirSync(join(folder, 'broken'));
  writeFileSync(join(folder, 'broken/bad.simulation.xml'), '<simulation><legs>4</legs></simulation>\n');
  const ui = useUi(
    () => UiProgram.serve([join(folder, 'mine/uniform.simulation.xml'), '--paused', '--recordings', folder], { XDG_STATE_HOME: join(folder, 'state') }),
    { takesControl: true },
  );

  after(() => rmSync(folder, { recursive: true }));

  const page = () => ui.viewer.page;
  const panel = () => page().getByTestId('open-panel');
  const find = () => panel().getByRole('searchbox', { name: 'Find' });
  const entry = (name: string) => panel().getByRole('button', { name, exact: true });
  const picture = (name: string) => entry(name).locator('svg');
  const count = async (text: string) => waitUntil(async () => (await panel().getByText(text, { exact: true }).count()) === 1);

  it('is part of the page Make, and begins with the scenarios of the project', async () => {
    await page().keyboard.press('3');
    await page().getByRole('button', { name: 'Open …' }).click();
    await entriesIn(page(), 'My project').nth(3).waitFor();
    const titles = await entriesIn(page(), 'My project').locator('strong').allTextContents();
    assert.deepEqual(titles.sort(), ['broken/bad', 'mine/coupled', 'mine/tail_fixed', 'mine/uniform']);
    const headings = await panel().getByRole('heading', { level: 3 }).allTextContents();
    assert.deepEqual(headings, ['My project', 'Gaits', 'Gait generators', 'Worlds and robots', 'Experiments']);
  });

  it('says what each of them is', async () => {
    await entry('mine/uniform').getByText('5 joints').waitFor();
    await entry('mine/uniform').getByText(/^0\.5\d m in 10 s$/).waitFor();
    await entry('mine/uniform').getByText('The travelling wave of the thesis').waitFor();
    await entry('broken/bad').getByText('bad.simulation.xml:1: found <legs> in <simulation>').waitFor();
    assert.equal(await picture('broken/bad').count(), 0);
  });

  it('has a picture of each that a simulation has made', async () => {
    // Simulations have the lowest priority: on a busy computer all of them take long, but each comes.
    const left = () => panel().getByText('computing …').count();
    for (let count = await left(); count > 0; count = await left()) {
      const before = count;
      assert.ok(await waitUntil(async () => (await left()) < before));
    }
    assert.equal(await panel().locator('svg').count(), (await panel().getByRole('listitem').count()) - 1, 'all but the one that is refused');
    for (const name of ['mine/uniform', 'Forward', 'Sidewinding', 'Hills, a ball and a crate', 'Sixty joints']) {
      await picture(name).scrollIntoViewIfNeeded();
      const pixels = await pixelsOf(page(), picture(name));
      assert.ok(countPixels(pixels, isBlue) > 100, `the robot of ${name}`);
    }
    await picture('Forward').scrollIntoViewIfNeeded();
    assert.ok(countPixels(await pixelsOf(page(), picture('Forward')), isPath) > 50, 'the way of the head');
    assert.match((await picture('Forward').getAttribute('aria-label')) ?? '', /^The robot with 5 joints and its way of 0\.5\d m in 10 s, from the side$/);
    assert.match((await picture('Sidewinding').getAttribute('aria-label')) ?? '', /from above$/);
  });

  it('opens what is pressed, and takes the world of another one', async () => {
    await entry('Sidewinding').click();
    await page().getByTestId('draft-file').filter({ hasText: 'sidewinding.simulation.xml' }).waitFor();
    await panel().waitFor({ state: 'detached' });
    await page().keyboard.press('Control+o');
    await find().fill('terrace');
    await panel().getByRole('button', { name: /^Use the world of/ }).first().click();
    await page().getByRole('button', { name: 'Undo' }).and(page().locator('[title*="environment of"]')).waitFor();
    await panel().waitFor({ state: 'detached' });
    await page().keyboard.press('Control+o');
    await find().fill('');
    await entry('mine/uniform').click();
    await page().getByTestId('draft-file').filter({ hasText: 'uniform.simulation.xml' }).waitFor();
    await panel().waitFor({ state: 'detached' });
    assert.equal(await page().getByTestId('draft-state').textContent(), 'saved', 'what was not saved belongs to the other scenario');
    await page().keyboard.press('Control+o');
  });

  it('is searched by words of the title, the text, the algorithm and the file', async () => {
    await find().fill('sidewinding');
    assert.ok(await count('1 scenario'));
    await find().fill('gaits hopf');
    assert.ok(await count('1 scenario'));
    assert.equal(await entry('Hopf oscillators').count(), 1);
    await find().fill('terrace REFLEX');
    assert.ok(await count('2 scenarios'));
    await find().fill('octopus');
    assert.ok(await count('Nothing has these words.'));
    await find().fill('');
    const all = await panel().getByRole('listitem').count();
    assert.ok(all > 30);
    assert.ok(await count(`${all} scenarios`));
  });

  it('works with the keyboard', async () => {
    const isShown = async () => (await panel().count()) === 1;
    await page().keyboard.press('Control+o');
    assert.ok(await waitUntil(async () => !(await isShown())));
    await page().keyboard.press('Control+o');
    assert.ok(await waitUntil(isShown));
    await page().waitForFunction(() => document.activeElement?.getAttribute('type') === 'search');
    await page().keyboard.type('turning');
    assert.ok(await count('1 scenario'));
    await page().keyboard.press('Tab');
    const focused = await page().evaluate(() => document.activeElement?.querySelector('strong')?.textContent);
    assert.equal(focused, 'Turning');
    await find().fill('');
  });

  it('is only looked at by those who do not drive', async () => {
    const other = await ui.look();
    await other.page.keyboard.press('3');
    await other.page.getByRole('button', { name: 'Open …' }).click();
    const forward = other.page.getByTestId('open-panel').getByRole('button', { name: 'Forward', exact: true });
    await forward.waitFor();
    assert.equal(await forward.getAttribute('aria-disabled'), 'true');
    assert.equal(await forward.getAttribute('title'), 'Take control first (C).');
  });

  for (const width of [1366, 600, 360]) {
    it(`fits a window ${width} pixels wide, and screen readers`, async () => {
      await page().setViewportSize({ width, height: 800 });
      await assertNothingIsCut(ui.viewer);
      assert.deepEqual(await seriousProblems(ui.viewer), []);
      await page().screenshot({ path: `build/page_test/open_${width}.png` });
    });
  }
});

describe('a project', () => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-page-'));
  const state = { XDG_STATE_HOME: join(folder, 'state') };
  const project = join(folder, 'school');
  cpSync('sim/scenarios/travelling_wave', project, { recursive: true });
  mkdirSync(join(folder, 'empty'));
  let browser: Browser;

  before(async () => {
    browser = await launchBrowser();
  });
  after(async () => {
    await browser.close();
    rmSync(folder, { recursive: true });
  });

  const look = async (words: string[], use: (viewer: Viewer) => Promise<void>) => {
    const program = await UiProgram.serve(words, state);
    try {
      const viewer = await Viewer.openAny(browser, program.address);
      await use(viewer);
      await viewer.close();
    } finally {
      await program.end();
    }
  };

  it('is opened by its folder: its recordings, and its scenarios in the page Make', async () => {
    await look([project], async ({ page }) => {
      await page.getByText('Recordings in school').waitFor();
      await page.keyboard.press('3');
      await page.getByText('No scenario is open').waitFor();
      await entriesIn(page, 'My project').nth(2).waitFor();
      assert.equal(await entriesIn(page, 'Gaits').count(), 9);
    });
  });

  it('has one panel New, which keeps the focus when its first draft comes', async () => {
    await look([project], async ({ page }) => {
      await page.keyboard.press('3');
      await page.getByText('No scenario is open').waitFor();
      await page.evaluate(() => {
        const panels = new Set<Element>();
        Object.assign(window, { panels });
        new MutationObserver(() => {
          const panel = document.querySelector('[data-testid=new-panel]');
          if (panel === null || panels.has(panel)) return;
          panels.add(panel);
          if (panels.size === 1) panel.querySelector('input')?.focus();
        }).observe(document.body, { childList: true, subtree: true });
      });
      await page.getByRole('button', { name: 'New …' }).click();
      await page.getByTestId('map-top').waitFor();
      const { count, hasFocus } = await page.evaluate(() => ({
        count: (window as unknown as { panels: Set<Element> }).panels.size,
        hasFocus: document.activeElement?.closest('[data-testid=new-panel]') != null,
      }));
      assert.deepEqual({ count, hasFocus }, { count: 1, hasFocus: true });
    });
  });

  it('fills the drawings with the robot of the first scenario that is opened, in windows of every size', async () => {
    await look([project], async ({ page }) => {
      await page.keyboard.press('3');
      await entriesIn(page, 'My project').first().click();
      const share = async () => {
        const [map, robot] = [await page.getByTestId('map-side').boundingBox(), await page.locator('[data-testid=map-side] .robot').boundingBox()];
        return map === null || robot === null ? 0 : robot.width / map.width;
      };
      await page.getByTestId('map-top').waitFor();
      for (const [width, height] of [[1366, 768], [1920, 1080], [390, 844]] as const) {
        await page.setViewportSize({ width, height });
        assert.ok(await waitUntil(async () => (await share()) > 0.03 && (await share()) <= 1), `${await share()} of the drawing at ${width} x ${height}`);
      }
    });
  });

  it('is in the list of the next program, which was started without it', async () => {
    await look(['--paused', '--recordings', join(folder, 'empty')], async ({ page }) => {
      await page.getByRole('navigation').getByRole('button', { name: 'Make' }).click();
      await page.getByRole('button', { name: 'Open …' }).click();
      await entriesIn(page, 'Last: school').nth(2).waitFor();
      assert.equal(await entriesIn(page, 'My project').count(), 0);
    });
  });

  it('gets its first robot in the page, which then crawls', async () => {
    await look([join(folder, 'empty')], async ({ page }) => {
      await page.keyboard.press('3');
      await page.getByRole('button', { name: 'New …' }).click();
      for (let i = 0; i < 3; i++) await page.getByRole('button', { name: 'Next' }).click();
      await page.getByRole('textbox', { name: 'name of the robot and of its folder' }).fill('first');
      await page.getByRole('button', { name: 'Create and start' }).click();
      await page.getByTestId('state').filter({ hasText: 'running' }).waitFor();
      await page.getByRole('navigation').locator('[aria-current=page]', { hasText: 'Live' }).waitFor();
      assert.ok(existsSync(join(folder, 'empty/first/robot.simulation.xml')));
    });
  });
});
