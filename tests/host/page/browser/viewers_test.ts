// Two viewers of one robot; a reload; a program that ends.
import assert from 'node:assert/strict';
import { beforeEach, describe, it } from 'node:test';
import { useUi } from './support/ui_fixture.js';
import { slowTime, UiProgram, uniform } from './support/ui_program.js';
import { lostConnection, type Viewer } from './support/viewer.js';
import { longest, waitUntil } from './support/waiting.js';

// In slow time: control goes to the next viewer when its holder's page is silent for a second.
const start = () => UiProgram.serve([uniform, '--paused'], slowTime);

describe('viewers', () => {
  const ui = useUi(start);
  let first: Viewer;
  let second: Viewer;

  beforeEach(async () => {
    first = ui.viewer;
    second = await ui.look();
    await first.takeControl();
    if (await first.button('Pause').isVisible()) await first.pause();
  });

  it('see who has control, and what the holder does', async () => {
    await second.page.getByTestId('control').filter({ hasText: 'has control' }).waitFor();
    await first.run();
    await second.waitForState('running');
    await second.waitForTick(50);
    assert.equal(await second.button('Pause').isDisabled(), true);
  });

  it('hand over: one asks, the other gives', async () => {
    await first.run();
    await second.button('Ask for control').click();
    await first.page.getByText('asks for control').waitFor();
    await first.screenshot('request');
    await first.button('Give control').click();
    await second.button('Release').waitFor();
    await first.button('Release').waitFor({ state: 'detached' });
    assert.equal(await first.button('Pause').isDisabled(), true);
    await first.waitForState('running');
    await second.button('Pause').click();
    await first.waitForState('paused');
  });

  it('may keep control, and who asked reads so', async () => {
    await second.button('Ask for control').click();
    await first.button('Keep control').click();
    await second.page.getByRole('list', { name: 'Notices' }).getByRole('listitem').first().waitFor();
    await first.button('Release').waitFor();
    assert.ok(await waitUntil(() => second.button('Ask for control').isEnabled()));
  });

  it('see what concerns the live robot when no window is in front, and on a phone the newest only', async () => {
    const notices = second.page.getByRole('list', { name: 'Notices' }).getByRole('listitem');
    await second.page.keyboard.press('?');
    await second.page.getByRole('dialog').waitFor();
    await first.button(/^STOP/).click();
    await second.waitForState('STOPPED');
    await first.run();
    await first.button(/^STOP/).click();
    await second.waitForState('STOPPED');
    assert.equal(await notices.count(), 0);
    await second.page.keyboard.press('Escape');
    await notices.nth(1).waitFor();
    await second.page.setViewportSize({ width: 390, height: 800 });
    assert.ok(await waitUntil(async () => (await notices.count()) === 1));
    await second.screenshot('notices_on_a_phone');
  });

  it('may take control at once after it was released', async () => {
    await first.button('Release').click();
    await second.takeControl();
  });

  it('look on after a reload beside another viewer, while the robot runs on', async () => {
    await first.run();
    await first.waitForTick(50);
    const tick = await first.tick();
    await first.page.reload();
    await first.waitForState('running');
    await first.waitForTick(tick + 20);
    assert.equal(await first.button('Pause').isDisabled(), true);
    await first.takeControl();
    await first.pause();
  });

  it('without the right token read what to do', async () => {
    const page = await ui.browser.newPage();
    page.setDefaultTimeout(longest);
    const address = ui.program.address.replace(/#.*/, '');
    await page.goto(address);
    await page.getByText('This address has no token').waitFor();
    await page.goto(`${address}#wrong`);
    await page.reload();
    await page.getByTestId('connection-band').filter({ hasText: 'does not accept this page' }).waitFor();
    await page.close();
  });
});

describe('a viewer alone', () => {
  const ui = useUi(start, { isPerTest: true });

  it('has control from the start, and again after a reload', async () => {
    await ui.viewer.button('Release').waitFor();
    await ui.viewer.run();
    await ui.viewer.page.reload();
    await ui.viewer.button('Release').waitFor();
    await ui.viewer.pause();
  });

  it('does not get control because the other viewer has left', async () => {
    const second = await ui.look();
    await second.button('Ask for control').waitFor();
    await ui.viewer.page.goto('about:blank');
    await second.page.getByTestId('control').filter({ hasText: 'Nobody has control' }).waitFor();
    await second.button('Take control').click();
    await second.button('Release').waitFor();
  });
});

describe('viewers of a program that ends', () => {
  const ui = useUi(start, { isPerTest: true, takesControl: true });

  it('read that the program has ended', async () => {
    ui.viewer.expected.push(lostConnection);
    await ui.viewer.run();
    await ui.viewer.waitForTick(50);
    await ui.program.end();
    await ui.viewer.page.getByTestId('connection-band').filter({ hasText: 'The program has ended' }).waitFor();
    await ui.viewer.waitForState('state unknown');
    assert.equal((await ui.viewer.angles()).length, 5, 'what was seen stays');
    await ui.viewer.screenshot('ended');
  });

  it('read that the connection is lost when the program is killed', async () => {
    ui.viewer.expected.push(lostConnection);
    await ui.program.kill();
    await ui.viewer.page.getByTestId('connection-band').filter({ hasText: 'No connection to the program' }).waitFor();
  });
});
