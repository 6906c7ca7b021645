// STOP, from every state and over both ways.
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { useUi } from './support/ui_fixture.js';
import { UiProgram } from './support/ui_program.js';

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

  it('works by Esc, in a text field too', async () => {
    await ui.viewer.run();
    await ui.viewer.parameter('1.amplitude').getByRole('textbox').focus();
    await ui.viewer.page.keyboard.press('Escape');
    await assertStopped();
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

  it('waits in a simulation until Esc has closed an open window', async () => {
    const { page } = ui.viewer;
    await ui.viewer.run();
    await page.keyboard.press('?');
    await page.getByRole('dialog').waitFor();
    await page.keyboard.press('Escape');
    await page.getByRole('dialog').waitFor({ state: 'detached' });
    await ui.viewer.waitForState('running');
    await page.keyboard.press('Escape');
    await assertStopped();
  });

  it('leaves what it is about readable, in windows of every width', async () => {
    const { page } = ui.viewer;
    await ui.viewer.run();
    await page.keyboard.press('Escape');
    await assertStopped();
    const size = page.viewportSize();
    for (const width of [1600, 1400, 1366, 1280, 390]) {
      await page.setViewportSize({ width, height: 800 });
      const cut = await page.evaluate(() =>
        ['.badge', '.top-bar .state', '[data-testid="control"] span']
          .map((selector) => document.querySelector(selector))
          .filter((element) => element !== null && element.scrollWidth > element.clientWidth)
          .map((element) => element?.textContent),
      );
      assert.deepEqual(cut, [], `at ${width} px`);
    }
    if (size !== null) await page.setViewportSize(size);
  });

  it('works while the robot is paused', async () => {
    await ui.viewer.run();
    await ui.viewer.pause();
    await ui.viewer.page.keyboard.press('Escape');
    await assertStopped();
  });

  it('says that it does not replace a power switch', async () => {
    await ui.viewer.page.getByText('does not replace a power switch', { exact: true }).waitFor();
    assert.match((await ui.viewer.button(/^STOP/).getAttribute('title')) ?? '', /does not replace a power switch/);
  });

  it('reaches a robot whose holder hangs: from another viewer', async () => {
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
    const pressed = ui.viewer.page.keyboard.press('Escape');
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
    await ui.viewer.page.keyboard.press('Escape');
    await ui.viewer.waitForState('STOPPED');
    assert.match(await ui.viewer.stopReport(/stopped/), /^stopped in \d+ ms$/);
  });
});
