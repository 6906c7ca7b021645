// The page Make: what a person arranges with the pointer and the clipboard. Joints: a table that a spreadsheet can fill, and
// columns that are dragged. Objects: copy, cut, paste, also into another scenario and another tab. The 3D view chooses both.
import assert from 'node:assert/strict';
import { cpSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import type { Page } from 'playwright-core';
import { seriousProblems } from './support/accessibility.js';
import { assertNothingIsCut } from './support/layout.js';
import { countPixelsWhen, isBlue, pixelsInside, pixelsOf } from './support/pixels.js';
import { useUi } from './support/ui_fixture.js';
import { UiProgram } from './support/ui_program.js';
import { Viewer } from './support/viewer.js';
import { waitUntil } from './support/waiting.js';

const readClipboard = (page: Page) => page.evaluate(() => navigator.clipboard.readText());
const writeClipboard = (page: Page, text: string) => page.evaluate((written) => navigator.clipboard.writeText(written), text);

// Of a chosen link or object in the 3D view: orange in both themes.
const isLit = (red: number, green: number, blue: number) => red > 120 && red > green + 25 && green > blue + 50;

describe('what is arranged in Make', () => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-page-'));
  for (const name of ['mine', 'other']) cpSync('sim/scenarios/travelling_wave', join(folder, name), { recursive: true });
  const ui = useUi(() => UiProgram.start(join(folder, 'mine/uniform.simulation.xml'), ['--recordings', folder]), { takesControl: true });
  after(() => rmSync(folder, { recursive: true }));

  const page = () => ui.viewer.page;
  const tab = (name: string) => page().getByRole('tab', { name });
  const chain = () => page().getByTestId('chain');
  const joint = (name: string) => chain().getByRole('button', { name, exact: true });
  const axes = async () => (await chain().locator('tbody td').allTextContents()).join('');
  const isAxes = async (expected: string) => assert.ok(await waitUntil(async () => (await axes()) === expected), await axes());
  const table = () => page().getByRole('dialog', { name: 'Table of joints' });
  const cell = (title: string, name: string) => table().getByRole('textbox', { name: `${title} of ${name}`, exact: true });
  const objects = () => page().getByRole('region', { name: 'Objects' });
  const rows = () => objects().getByRole('listitem').count();
  const isRows = async (expected: number) => assert.ok(await waitUntil(async () => (await rows()) === expected), `${await rows()} rows`);
  const row = (number: number) => objects().locator('.objects button').nth(number);
  const isChosen = async (number: number) => assert.ok(await waitUntil(async () => (await row(number).getAttribute('aria-pressed')) === 'true'));
  const object = (name: string) => objects().getByRole('button', { name, exact: true });
  const field = (name: string) => objects().getByRole('textbox', { name, exact: true });
  const add = async (item: string) => {
    await page().getByRole('region', { name: 'Library' }).getByRole('button', { name: item, exact: true }).click();
    await page().getByRole('button', { name: `Add ${item}` }).click();
  };
  const focusMap = () => page().getByTestId('map-top').focus();
  const notice = (text: string | RegExp) => page().getByRole('list', { name: 'Notices' }).getByText(text).first().waitFor();

  before(async () => {
    await page().context().grantPermissions(['clipboard-read', 'clipboard-write']);
    await page().keyboard.press('3');
    await tab('Robot').click();
    await isAxes('ppppp');
  });

  describe('the table of joints', () => {
    it('takes cells of a spreadsheet from the chosen joint on, as one change', async () => {
      await joint('J2').click();
      await page().getByRole('button', { name: 'Table …' }).click();
      assert.ok(await cell('name', 'J2').evaluate((input) => input === document.activeElement || input.tabIndex === 0));
      await cell('axis', 'J2').focus();
      await writeClipboard(page(), 'yaw\t-30\t45,5\r\n0\t\t60\r\n');
      await page().keyboard.press('Control+v');
      assert.ok(await waitUntil(async () => (await cell('highest angle', 'J3').inputValue()) === '60'));
      assert.equal(await cell('highest angle', 'J2').inputValue(), '45.5');
      assert.equal(await cell('lowest angle', 'J3').inputValue(), '-90', 'an empty cell leaves the value');
      await isAxes('pyppp');
    });

    it('is copied with its titles, and takes them back', async () => {
      await page().keyboard.press('Control+a');
      await page().keyboard.press('Control+c');
      assert.ok(await waitUntil(async () => (await readClipboard(page())).startsWith('name\taxis (°)\t')));
      const text = await readClipboard(page());
      assert.equal(text.split('\n').length, 6);
      assert.match(text, /\nJ2\t90\t-30\t45\.5\t/);
      await writeClipboard(page(), 'speed (rad/s)\tname\n3,5\tneck');
      await cell('torque', 'J4').focus();
      await page().keyboard.press('Control+v');
      await cell('name', 'neck').waitFor();
      assert.equal(await cell('speed', 'neck').inputValue(), '3.5');
    });

    it('names a bad cell, and takes nothing of the text', async () => {
      await cell('torque', 'J1').focus();
      await writeClipboard(page(), '1\t2\n3\tquick');
      await page().keyboard.press('Control+v');
      await table().getByRole('alert').filter({ hasText: "J2, speed: found 'quick', expected a number (row 2, column 2 of the text)" }).waitFor();
      assert.equal(await cell('speed', 'J2').getAttribute('aria-invalid'), 'true');
      await writeClipboard(page(), '1\n-3');
      await page().keyboard.press('Control+v');
      await table().getByRole('alert').filter({ hasText: "Nothing was changed: torque of J2: found '-3'" }).waitFor();
      assert.notEqual(await cell('torque', 'J1').inputValue(), '1');
      assert.deepEqual(await seriousProblems(ui.viewer), []);
      await page().screenshot({ path: 'build/page_test/make_joint_table.png' });
    });

    it('offers to add the joints that the text has more', async () => {
      await cell('name', 'J5').focus();
      await writeClipboard(page(), 'e\tyaw\nf\tpitch\ng\tyaw');
      await page().keyboard.press('Control+v');
      await table().getByRole('alert').filter({ hasText: 'the text has 2 more rows than joints from the chosen one on' }).waitFor();
      await table().getByRole('button', { name: 'Add 2 joints at the head and paste' }).click();
      await cell('name', 'g').waitFor();
      await page().keyboard.press('Escape');
      await table().waitFor({ state: 'detached' });
      await isAxes('pyppypy');
      await focusMap();
      await page().keyboard.press('Control+z');
      await isAxes('pyppp');
    });

    it('is copied and filled without being open; a text field keeps its keys', async () => {
      await joint('J1').click();
      await joint('J2').click({ modifiers: ['Shift'] });
      await focusMap();
      await page().keyboard.press('Control+c');
      assert.ok(await waitUntil(async () => (await readClipboard(page())).split('\n').length === 3), await readClipboard(page()));
      await writeClipboard(page(), 'yaw');
      const name = page().getByRole('region', { name: 'Chain' }).getByRole('textbox', { name: 'name', exact: true });
      await name.selectText();
      await page().keyboard.press('Control+v');
      assert.equal(await name.inputValue(), 'yaw');
      await page().keyboard.press('Control+a');
      await page().keyboard.press('Control+c');
      assert.equal(await readClipboard(page()), 'yaw');
      await page().keyboard.press('Control+z');
      await joint('J3').click();
      await focusMap();
      await writeClipboard(page(), 'name\taxis\nknee\tyaw');
      await page().keyboard.press('Control+v');
      await cell('name', 'knee').waitFor();
      await page().keyboard.press('Escape');
      await isAxes('pyypp');
    });
  });

  describe('the chain', () => {
    const centre = async (name: string) => {
      const box = await joint(name).boundingBox();
      assert.ok(box !== null);
      return { x: box.x + box.width / 2, y: box.y + box.height / 2, width: box.width };
    };

    it('has a joint that is dragged where the line is', async () => {
      const from = await centre('J1');
      const to = await centre('knee');
      await page().mouse.move(from.x, from.y);
      await page().mouse.down();
      await page().mouse.move(to.x - to.width / 4, to.y, { steps: 6 });
      await chain().locator('th.line-before', { hasText: 'knee' }).waitFor();
      await page().screenshot({ path: 'build/page_test/make_joint_drag.png' });
      await page().mouse.up();
      await isAxes('ypypp');
      await focusMap();
      await page().keyboard.press('Control+z');
      await isAxes('pyypp');
    });

    it('stays as it is when Esc gives the drag up', async () => {
      const from = await centre('J1');
      await page().mouse.move(from.x, from.y);
      await page().mouse.down();
      await page().mouse.move(from.x + 3 * from.width, from.y, { steps: 6 });
      await chain().locator('.line-before').first().waitFor();
      await page().keyboard.press('Escape');
      assert.equal(await chain().locator('.line-before').count(), 0);
      await page().mouse.up();
      assert.equal(await axes(), 'pyypp');
      await page().keyboard.press('Control+y');
      await isAxes('ypypp');
      await page().keyboard.press('Control+z');
      await isAxes('pyypp');
    });

    it('has handles for arrow keys and for a finger', async () => {
      const handle = (name: string) => chain().getByRole('button', { name: `place of ${name}: left and right arrow keys move it` });
      await handle('J1').focus();
      await page().keyboard.press('ArrowRight');
      await isAxes('ypypp');
      assert.ok(await waitUntil(() => chain().locator('tfoot td:nth-child(3) .handle').evaluate((button) => button === document.activeElement)));
      await page().keyboard.press('ArrowLeft');
      await isAxes('pyypp');
      const from = (await chain().locator('.handle').first().boundingBox())!;
      const to = (await chain().locator('.handle').nth(1).boundingBox())!;
      await chain().locator('.handle').first().evaluate(
        (button, [begin, end, y]) => {
          button.setPointerCapture = () => {}; // the pointer of a script cannot be captured
          const touch = (type: string, x: number) =>
            button.dispatchEvent(new PointerEvent(type, { pointerId: 7, pointerType: 'touch', bubbles: true, clientX: x, clientY: y as number, button: 0 }));
          touch('pointerdown', begin as number);
          touch('pointermove', ((begin as number) + (end as number)) / 2);
          touch('pointermove', end as number);
          touch('pointerup', end as number);
        },
        [from.x + 5, to.x + to.width - 2, from.y + 5] as const,
      );
      await isAxes('ypypp');
      await focusMap();
      await page().keyboard.press('Control+z');
      await isAxes('pyypp');
    });
  });

  describe('objects', () => {
    it('are copied, cut and pasted; the steps of stairs belong together', async () => {
      await tab('World').click();
      await add('stairs');
      await isRows(2);
      await isChosen(1);
      await focusMap();
      await page().keyboard.press('Control+c');
      assert.ok(await waitUntil(async () => (await readClipboard(page())).startsWith('<KinBody')));
      await page().keyboard.press('Control+v');
      await isRows(3);
      await isChosen(2);
      await page().keyboard.press('Control+x');
      await isRows(2);
      await row(1).click();
      await focusMap();
      await page().keyboard.press('Control+d');
      await isRows(3);
      for (const left of [2, 3, 2]) {
        await page().keyboard.press('Control+z');
        await isRows(left);
      }
    });

    it('are copied several at once', async () => {
      await add('box');
      await isRows(3);
      await row(1).click();
      await object('box').click({ modifiers: ['Shift'] });
      await objects().getByText('2 objects', { exact: true }).waitFor();
      await objects().getByRole('button', { name: 'Copy', exact: true }).click();
      assert.ok(await waitUntil(async () => (await readClipboard(page())).split('<KinBody').length === 3));
      await objects().getByRole('button', { name: 'Paste', exact: true }).click();
      await isRows(5);
      await isChosen(4);
      await focusMap();
      await page().keyboard.press('Delete');
      await isRows(3);
      for (const left of [5, 3]) {
        await page().keyboard.press('Control+z');
        await isRows(left);
      }
    });

    it('go into another tab, and into another scenario that is opened later', async () => {
      await object('box').click();
      const x = await field('x in m').inputValue();
      await focusMap();
      await writeClipboard(page(), '');
      await page().keyboard.press('Control+c');
      assert.ok(await waitUntil(async () => (await readClipboard(page())).includes('box')));
      const other = await UiProgram.start(join(folder, 'other/uniform.simulation.xml'), ['--recordings', folder]);
      try {
        const viewer = await Viewer.open(ui.browser, other.address);
        await viewer.takeControl();
        await viewer.page.keyboard.press('3');
        await viewer.page.getByTestId('map-top').focus();
        await viewer.page.keyboard.press('Control+v');
        const pasted = viewer.page.getByRole('region', { name: 'Objects' });
        await pasted.getByRole('button', { name: 'box', exact: true }).waitFor();
        assert.equal(await pasted.getByRole('textbox', { name: 'x in m', exact: true }).inputValue(), x, 'it stands where it stood');
        await viewer.close();
      } finally {
        await other.end();
      }
      await page().keyboard.press('Control+o');
      await page().getByTestId('open-panel').getByRole('button', { name: 'other/uniform', exact: true }).click();
      await isRows(1);
      await focusMap();
      await page().keyboard.press('Control+v');
      await isRows(2);
      assert.equal(await field('x in m').inputValue(), x);
    });

    it('are nothing else that a clipboard has: it gets one line', async () => {
      for (const [text, reason] of [
        ['hello', "found 'hello', expected objects of a world"],
        ['<KinBody file="/etc/passwd"/>', "names the file '/etc/passwd'"],
        ['<KinBody name="a"><Body type="static"><Geom type="trimesh"><data>../../etc/passwd</data></Geom></Body></KinBody>', 'a mesh that this scenario has already'],
        [`<KinBody name="${'x'.repeat(70000)}"/>`, 'KiB of text'],
      ] as const) {
        await writeClipboard(page(), text);
        await focusMap();
        await page().keyboard.press('Control+v');
        await notice(new RegExp(reason.replace(/[.*+?^${}()|[\]\\/]/g, '\\$&')));
        assert.equal(await rows(), 2);
      }
    });
  });

  describe('the 3D view', () => {
    const scene = () => page().locator('.make').getByTestId('scene');
    const place = async (matches: (red: number, green: number, blue: number) => boolean) => {
      const inside = pixelsInside(await pixelsOf(page(), scene()), matches);
      const middle = inside[Math.floor(inside.length / 2)];
      assert.ok(middle !== undefined, 'there is nothing of this colour');
      return middle;
    };

    it('chooses the link that is clicked, and lights it everywhere', async () => {
      await page().mouse.move(5, 5);
      const at = await place(isBlue);
      await scene().click({ position: at });
      assert.ok(await waitUntil(async () => (await chain().locator('thead button[aria-pressed=true]').count()) === 1));
      await page().mouse.move(5, 5);
      assert.ok((await countPixelsWhen(page(), scene(), isLit, (count) => count > 30)) > 30);
      assert.equal(await page().locator('[data-testid=map-top] .robot polygon.lit').count() > 0, true);
      await page().screenshot({ path: 'build/page_test/make_choose.png' });
    });

    it('chooses several with Shift; a drag still turns the view', async () => {
      const chosen = () => chain().locator('thead button[aria-pressed=true]').allTextContents();
      const first = await chosen();
      const blue = pixelsInside(await pixelsOf(page(), scene()), isBlue);
      for (const at of [blue[0]!, blue.at(-1)!]) {
        if ((await chosen()).length === 1) await scene().click({ position: at, modifiers: ['Shift'] });
        await waitUntil(async () => (await chosen()).length !== 1);
      }
      assert.equal((await chosen()).length, 2);
      const before = await chosen();
      const box = (await scene().boundingBox())!;
      await page().mouse.move(box.x + box.width / 2, box.y + box.height / 2);
      await page().mouse.down();
      await page().mouse.move(box.x + box.width / 2 + 60, box.y + box.height / 2, { steps: 5 });
      await page().mouse.up();
      assert.deepEqual(await chosen(), before);
      assert.equal(first.length, 1);
    });

    it('chooses an object; beside all of them nothing is chosen', async () => {
      await tab('World').click();
      await object('box').click();
      await page().mouse.move(5, 5);
      assert.ok((await countPixelsWhen(page(), scene(), isLit, (count) => count > 30)) > 30);
      await tab('Robot').click();
      await page().getByRole('button', { name: /Choose all|Choose none/ }).click();
      await tab('World').click();
      const box = (await scene().boundingBox())!;
      await scene().click({ position: { x: box.width / 2, y: box.height - 8 } });
      assert.ok(await waitUntil(async () => (await objects().locator('button[aria-pressed=true]').count()) === 0));
    });
  });

  it('fits a phone, and axe-core finds nothing serious', async () => {
    await tab('Robot').click();
    for (const width of [1366, 360]) {
      await page().setViewportSize({ width, height: 800 });
      await assertNothingIsCut(ui.viewer);
      assert.deepEqual(await seriousProblems(ui.viewer), []);
      await page().screenshot({ path: `build/page_test/make_arrange_${width}.png` });
      await page().keyboard.press('t');
      await table().waitFor();
      await assertNothingIsCut(ui.viewer);
      await page().screenshot({ path: `build/page_test/make_joint_table_${width}.png` });
      await page().keyboard.press('Escape');
    }
    await page().setViewportSize({ width: 1366, height: 800 });
  });
});
