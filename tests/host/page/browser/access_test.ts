// Who cannot use a mouse, has a narrow window, or works in the dark; and a long robot.
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { seriousProblems } from './support/accessibility.js';
import { assertNothingIsCut } from './support/layout.js';
import { countPixelsWhen, isBlue } from './support/pixels.js';
import { useUi } from './support/ui_fixture.js';
import { sixty, UiProgram } from './support/ui_program.js';
import type { Look } from './support/viewer.js';

const looks: readonly Look[] = [
  { name: 'wide_light', width: 1400, colours: 'light' },
  { name: 'wide_dark', width: 1400, colours: 'dark' },
  { name: 'narrow_light', width: 600, colours: 'light' },
  { name: 'narrow_dark', width: 600, colours: 'dark' },
];

describe('the page', () => {
  const ui = useUi(() => UiProgram.start());

  for (const look of looks) {
    it(`has no serious problem for axe-core, looking on and in control, and STOP in the window (${look.name})`, async () => {
      const { viewer } = ui;
      await viewer.lookAs(look);
      await viewer.lookOn();
      assert.deepEqual(await seriousProblems(viewer), []);
      await viewer.takeControl();
      if (look === looks[0]) {
        await viewer.run();
        await viewer.waitForTick(200);
      }
      assert.deepEqual(await seriousProblems(viewer), []);
      const { width } = look;
      const box = await viewer.button(/^STOP/).boundingBox();
      assert.ok(box !== null && box.x >= 0 && box.x + box.width <= width && box.y >= 0, `found ${JSON.stringify(box)}`);
      await assertNothingIsCut(viewer);
      await viewer.screenshot(look.name);
      await viewer.page.mouse.wheel(0, 1500);
      assert.deepEqual(await viewer.button(/^STOP/).boundingBox(), box, 'at the same place after scrolling');
      await viewer.page.mouse.wheel(0, -1500);
      await viewer.lookOn();
    });
  }

  it('has dialogs without serious problems, and STOP stays within reach', async () => {
    const { viewer } = ui;
    for (const [key, title] of [['?', 'Keys'], ['Control+k', 'Find an action'], ['x', 'Command that gives the same run']] as const) {
      await viewer.page.keyboard.press(key);
      const dialog = viewer.page.getByRole('dialog', { name: title });
      await dialog.waitFor();
      assert.deepEqual(await seriousProblems(viewer), []);
      await viewer.screenshot(`dialog_${title.split(' ')[0]?.toLowerCase()}`);
      await viewer.button(/^STOP/).click({ trial: true });
      await dialog.getByRole('button', { name: 'Close', exact: true }).click();
      await dialog.waitFor({ state: 'detached' });
    }
  });

  it('is dark or light as the system says, until the user chooses', async () => {
    const viewer = await ui.look({ colorScheme: 'dark' });
    const background = () => viewer.page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    const dark = await background();
    await viewer.page.emulateMedia({ colorScheme: 'light' });
    await viewer.page.waitForFunction(() => document.documentElement.dataset['theme'] === 'light');
    const light = await background();
    assert.notEqual(dark, light);
    await viewer.page.keyboard.press('t');
    await viewer.page.keyboard.press('t');
    await viewer.page.waitForFunction(() => document.documentElement.dataset['theme'] === 'dark');
    assert.equal(await background(), dark);
  });

  it('can be used with the keyboard alone', async () => {
    const { viewer } = ui;
    const { keyboard } = viewer.page;
    await keyboard.press('c');
    await viewer.button('Release').waitFor();
    await viewer.waitForState('running');
    await keyboard.press('k');
    await viewer.waitForState('paused');
    const tick = await viewer.tick();
    await keyboard.press('.');
    await viewer.waitForTick(tick + 1);
    await keyboard.press('Control+k');
    await viewer.page.getByRole('combobox', { name: 'Name of the action' }).waitFor();
    await keyboard.type('restart'); // at once: the dialog has the focus
    await keyboard.press('Enter');
    await viewer.page.waitForFunction((before) => Number(document.querySelector('[data-testid=tick]')?.textContent) < before, tick);
    // Tab reaches a slider, whose focus can be seen; the arrows change it.
    for (let i = 0; i < 60; i += 1) {
      await keyboard.press('Tab');
      const label = await viewer.page.evaluate(() => document.activeElement?.getAttribute('aria-label'));
      if (label === 'amplitude, all joints') break;
    }
    const outline = await viewer.page.evaluate(() => getComputedStyle(document.activeElement as Element).outlineStyle);
    assert.equal(outline, 'solid');
    const [before] = await viewer.valuesOf('1.amplitude');
    await keyboard.press('ArrowRight');
    await viewer.page.waitForFunction(
      (old) => !document.querySelector('[data-parameter="1.amplitude"] [data-cell]')?.getAttribute('title')?.includes(`wanted ${old},`),
      before?.wanted,
    );
    await keyboard.press('Control+z');
    await keyboard.press('Space');
    await viewer.waitForState('STOPPED');
  });
});

describe('a robot with 60 joints', () => {
  const ui = useUi(() => UiProgram.start(sixty), { takesControl: true });

  it('is shown in 3D, strip, table and cells', async () => {
    const { viewer } = ui;
    await viewer.run();
    await viewer.waitForTick(100);
    const angles = await viewer.angles();
    assert.equal(angles.length, 60);
    await viewer.waitForTick((await viewer.tick()) + 30);
    await viewer.waitForOtherAngles(angles);
    assert.equal(await viewer.page.locator('.parameter').first().locator('[data-cell]').count(), 60);
    assert.ok((await countPixelsWhen(viewer.page, viewer.page.locator('.scene'), isBlue, (count) => count > 200)) > 200);
    await viewer.screenshot('sixty_joints');
  });
});
