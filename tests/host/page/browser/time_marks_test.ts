// Markers and loop in the time view, from the keyboard.
import assert from 'node:assert/strict';
import { before, describe, it } from 'node:test';
import { waitUntil } from './support/waiting.js';
import { useUi } from './support/ui_fixture.js';
import { UiProgram } from './support/ui_program.js';

describe('markers and loop', () => {
  const ui = useUi(() => UiProgram.start(), { takesControl: true });

  before(async () => {
    await ui.viewer.run();
    await ui.viewer.waitForTick(300);
    await ui.viewer.pause();
    await ui.viewer.button('Run').focus();
  });

  const press = async (...keys: string[]) => {
    for (const key of keys) await ui.viewer.page.keyboard.press(key);
  };
  const cursor = async () => Number(/cursor at (\S+) s/.exec((await ui.viewer.page.locator('.cursor-time').textContent()) ?? '')?.[1]);

  it('are set at the cursor, named, jumped to and removed', async () => {
    const markers = ui.viewer.page.getByTestId('markers');
    await press('Shift+ArrowLeft', 'm', 'Shift+ArrowLeft', 'm');
    const first = await cursor();
    assert.equal(await markers.getByRole('listitem').count(), 2);
    const name = markers.getByLabel('Name of the marker').first();
    await name.fill('stumbles');
    await name.press('Enter');
    await markers.getByLabel('Remove the marker stumbles').waitFor();
    await press('l');
    await markers.getByTitle('Show this time').first().click();
    assert.equal(await cursor(), first);
    await ui.viewer.screenshot('markers');
    await markers.getByLabel('Remove the marker stumbles').click();
    assert.equal(await markers.getByRole('listitem').count(), 1);
  });

  it('plays round between the ends of the loop, and pauses', async () => {
    await ui.viewer.button('Run').focus();
    await press('[');
    const from = await cursor();
    for (let tick = 0; tick < 20; tick += 1) await press('ArrowRight');
    const to = await cursor();
    assert.ok(Math.abs(to - from - 0.2) < 0.001, `the loop from ${from} s to ${to} s is 0.2 s long`);
    await press(']');
    await ui.viewer.button('Pause loop').waitFor();
    const seen = new Set<number>();
    await ui.viewer.page.waitForFunction(() => document.querySelector('.cursor-time') !== null);
    assert.ok(await waitUntil(async () => seen.add(await cursor()).size >= 5), 'the cursor moves');
    for (const time of seen) assert.ok(time >= from && time <= to, `${time} s is in the loop`);
    await ui.viewer.screenshot('loop');
    await ui.viewer.button('Run').focus();
    await press('Shift+P');
    await ui.viewer.button('Play loop').waitFor();
    const still = await cursor();
    await ui.viewer.page.waitForTimeout(300);
    assert.equal(await cursor(), still);
  });

  it('has its keys in the list of keys', async () => {
    await press('?');
    const keys = ui.viewer.page.getByRole('dialog', { name: 'Keys' });
    for (const title of ['Set a marker at the time cursor', 'Loop: begin at the time cursor', 'Loop: end at the time cursor']) {
      await keys.getByText(title).waitFor();
    }
    await ui.viewer.button('Close').click();
  });
});
