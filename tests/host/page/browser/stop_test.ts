// STOP, from every state and over both ways; Esc in a simulation.
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { useUi } from './support/ui_fixture.js';
import { UiProgram } from './support/ui_program.js';
import { waitUntil } from './support/waiting.js';

describe('STOP', () => {
  const ui = useUi(() => UiProgram.start(), { takesControl: true });

  async function assertStopped(): Promise<void> {
    await ui.viewer.waitForState('STOPPED');
    assert.match(await ui.viewer.stopReport(), /^stopped in \d+ ms, 5 of 5 confirmed$/);
  }

  it('works by a press of its button while the robot runs; the holder may run on', async () => {
    await ui.viewer.run();
    await ui.viewer.waitForTick(30);
    await ui.viewer.button(/^STOP/).click();
    await assertStopped();
    await ui.viewer.screenshot('stopped');
    const tick = await ui.viewer.tick();
    await ui.viewer.run();
    await ui.viewer.waitForTick(tick + 20);
    assert.equal(await ui.viewer.page.getByTestId('stop-report').textContent(), '', 'the report is of the past');
    await ui.viewer.pause();
  });

  it('works by Space outside text fields, also when a button has the focus', async () => {
    await ui.viewer.run();
    await ui.viewer.button('Release').focus();
    await ui.viewer.page.keyboard.press('Space');
    await assertStopped();
    await ui.viewer.button('Release').waitFor();
  });

  it('does not work by Space in a text field, where it is a space', async () => {
    await ui.viewer.run();
    await ui.viewer.page.keyboard.press('Control+k');
    await ui.viewer.page.getByRole('combobox', { name: 'Name of the action' }).pressSequentially('run or');
    await ui.viewer.waitForState('running');
    await ui.viewer.button(/^STOP/).click();
    await assertStopped();
    await ui.viewer.button('Close').click();
  });

  it('works by Space in an open window, which stays open', async () => {
    const { page } = ui.viewer;
    await ui.viewer.run();
    await page.keyboard.press('?');
    await page.getByRole('dialog').getByText('Space outside text fields is STOP').waitFor();
    await page.keyboard.press('Space');
    await assertStopped();
    await page.keyboard.press('Escape');
    await page.getByRole('dialog').waitFor({ state: 'detached' });
  });

  it('leaves what it is about readable, in windows of every width', async () => {
    const { page } = ui.viewer;
    await ui.viewer.run();
    await page.keyboard.press('Space');
    await assertStopped();
    const size = page.viewportSize();
    for (const width of [1600, 1400, 1366, 1280, 390]) {
      await page.setViewportSize({ width, height: 800 });
      const cut = await page.evaluate(() =>
        ['.badge', '.top-bar .state', '[data-testid="control"] span']
          .map((selector) => document.querySelector(selector))
          // Both are rounded, each in its way: 122.33 pixels can be 123 and 122.
          .filter((element) => element !== null && element.scrollWidth > element.clientWidth + 1)
          .map((element) => element?.textContent),
      );
      assert.deepEqual(cut, [], `at ${width} px`);
    }
    if (size !== null) await page.setViewportSize(size);
  });

  it('works while the robot is paused', async () => {
    await ui.viewer.run();
    await ui.viewer.pause();
    await ui.viewer.page.keyboard.press('Space');
    await assertStopped();
  });

  it('says that it does not replace a power switch', async () => {
    await ui.viewer.page.getByText('does not replace a power switch', { exact: true }).waitFor();
    assert.match((await ui.viewer.button(/^STOP/).getAttribute('title')) ?? '', /does not replace a power switch/);
  });

  it('reaches a robot whose holder hangs: from another viewer, also by Esc', async () => {
    const other = await ui.look();
    await ui.viewer.run();
    const goOn = await ui.viewer.hang();
    await other.page.getByTestId('control').filter({ hasText: 'is away' }).waitFor();
    await other.page.keyboard.press('Escape');
    await other.waitForState('STOPPED');
    assert.match(await other.stopReport(), /5 of 5 confirmed/);
    await goOn();
    await ui.viewer.waitForState('STOPPED');
  });

  it('is kept while the page hangs, and takes effect when it goes on', async () => {
    await ui.viewer.run();
    const goOn = await ui.viewer.hang();
    const pressed = ui.viewer.page.keyboard.press('Space');
    await goOn();
    await pressed;
    await assertStopped();
  });

  it('goes by POST if its socket is stuck', async () => {
    // Takes what the page sends on the socket of STOP, and never answers. Sockets of workers are not affected.
    await ui.viewer.page.routeWebSocket(/\/socket$/, () => {});
    await ui.viewer.page.reload();
    await ui.viewer.takeControl();
    await ui.viewer.run();
    await ui.viewer.page.keyboard.press('Space');
    await ui.viewer.waitForState('STOPPED');
    assert.match(await ui.viewer.stopReport(/stopped/), /^stopped in \d+ ms$/);
  });
});

describe('Esc in a simulation', () => {
  const ui = useUi(() => UiProgram.start(), { takesControl: true });
  const press = () => ui.viewer.page.keyboard.press('Escape');

  it('pauses, in a text field too, and does no more while the simulation is paused', async () => {
    await ui.viewer.run();
    await ui.viewer.parameter('1.amplitude').getByRole('textbox').focus();
    await press();
    await ui.viewer.waitForState('paused');
    await press();
    await ui.viewer.page.keyboard.press('Shift+R');
    await ui.viewer.waitForState('paused');
    assert.equal(await ui.viewer.page.getByTestId('stop-report').textContent(), '', 'it was no STOP');
  });

  it('changes nothing after STOP', async () => {
    await ui.viewer.button(/^STOP/).click();
    await ui.viewer.waitForState('STOPPED');
    await press();
    const field = ui.viewer.parameter('1.amplitude').getByRole('textbox');
    await field.fill('33');
    await field.press('Enter');
    // The program works in turn: what Esc had asked for would have its effect before.
    assert.ok(await waitUntil(async () => (await ui.viewer.valuesOf('1.amplitude')).every(({ wanted }) => wanted === '33')));
    await ui.viewer.waitForState('STOPPED');
    await ui.viewer.button('Reset all').click();
  });

  it('closes an open window first, and pauses when it is pressed again', async () => {
    const { page } = ui.viewer;
    await ui.viewer.run();
    for (const key of ['?', 'Control+k']) {
      await page.keyboard.press(key);
      await page.getByRole('dialog').waitFor();
      await press();
      await page.getByRole('dialog').waitFor({ state: 'detached' });
      await ui.viewer.waitForState('running');
    }
    await press();
    await ui.viewer.waitForState('paused');
  });

  it('gives up the value that is typed into a cell, and ends Move', async () => {
    const { page } = ui.viewer;
    await ui.viewer.run();
    const cell = ui.viewer.parameter('1.amplitude').locator('[data-cell="1"]');
    await cell.focus();
    await page.keyboard.type('7');
    const field = ui.viewer.parameter('1.amplitude').locator('.cell-input');
    await field.waitFor();
    await press();
    await field.waitFor({ state: 'detached' });
    await ui.viewer.waitForState('running');
    assert.equal((await ui.viewer.valuesOf('1.amplitude'))[1]?.wanted, '40');
    await ui.viewer.pause();
    await ui.viewer.button('Move').click();
    const form = page.getByRole('form', { name: 'Place of the head' });
    await form.waitFor();
    await press();
    await form.waitFor({ state: 'detached' });
  });

  it('closes the changes to save on the page Make, and pauses from there', async () => {
    const { page } = ui.viewer;
    await ui.viewer.run();
    await page.keyboard.press('3');
    await page.getByTestId('map-top').waitFor();
    await page.keyboard.press('Control+s');
    await page.getByTestId('save-panel').waitFor();
    await press();
    await page.getByTestId('save-panel').waitFor({ state: 'detached' });
    await ui.viewer.waitForState('running');
    await press();
    await ui.viewer.waitForState('paused');
    await page.keyboard.press('1');
  });

  it('is STOP for those who look on', async () => {
    const other = await ui.look();
    await ui.viewer.run();
    await other.waitForState('running');
    await other.button('Ask for control').waitFor();
    await other.page.keyboard.press('Escape');
    await other.waitForState('STOPPED');
  });
});
