// A simulated robot, live: it moves, and does what the page says.
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { seriousProblems } from './support/accessibility.js';
import { assertNothingIsCut } from './support/layout.js';
import { countDifferences, countPixels, countPixelsWhen, isBlue, pixelsOf } from './support/pixels.js';
import { useUi } from './support/ui_fixture.js';
import { UiProgram } from './support/ui_program.js';
import type { Viewer } from './support/viewer.js';
import { waitForFrames, waitUntil } from './support/waiting.js';

describe('a live simulation', () => {
  const ui = useUi(() => UiProgram.start());

  it('is labelled as a simulation, and its address no longer has the token', async () => {
    await ui.viewer.page.getByText('SIMULATION', { exact: true }).waitFor();
    assert.equal(new URL(ui.viewer.page.url()).hash, '');
  });

  it('is driven by its only viewer from the start', async () => {
    await ui.viewer.button('Release').waitFor();
    assert.equal(await ui.viewer.button('Run').isEnabled(), true);
  });

  it('is only looked on by a second viewer: nothing can be changed without control', async () => {
    const second = await ui.look();
    await second.button('Ask for control').waitFor();
    assert.equal(await second.button('Run').isDisabled(), true);
    assert.equal(await second.parameter('1.amplitude').getByRole('slider').first().isDisabled(), true);
    assert.equal(await second.button(/^STOP/).isEnabled(), true);
  });

  it('runs: the joints move, the head advances, and the picture changes', async () => {
    await ui.viewer.takeControl();
    await ui.viewer.run();
    await ui.viewer.waitForTick(100);
    const scene = ui.viewer.page.locator('.scene');
    const angles = await ui.viewer.angles();
    const start = await ui.viewer.head();
    assert.ok((await countPixelsWhen(ui.viewer.page, scene, isBlue, (count) => count > 500)) > 500, 'the robot is in the picture');
    const picture = await pixelsOf(ui.viewer.page, scene);
    await ui.viewer.waitForTick((await ui.viewer.tick()) + 140);
    assert.ok(await waitUntil(async () => countDifferences(picture, await pixelsOf(ui.viewer.page, scene)) > 500), 'the picture changes');
    assert.equal(angles.length, 5);
    await ui.viewer.waitForOtherAngles(angles);
    assert.notDeepEqual(await ui.viewer.head(), start);
    await ui.viewer.screenshot('live');
  });

  it('has strip and plot filled with colour', async () => {
    const strip = await pixelsOf(ui.viewer.page, ui.viewer.page.getByTestId('strip'));
    const isOrange = (red: number, green: number, blue: number) => red > 180 && green > 60 && green < 190 && blue < 120;
    assert.ok(countPixels(strip, isOrange) > 200);
    assert.ok(countPixels(strip, isBlue) > 200);
    const plot = await pixelsOf(ui.viewer.page, ui.viewer.page.getByTestId('plot'));
    assert.ok(countPixels(plot, isBlue) > 100);
  });

  it('pauses, steps by as many ticks as asked for, and restarts', async () => {
    await ui.viewer.pause();
    const tick = await settledTick(ui.viewer);
    await ui.viewer.page.getByLabel('Ticks of a step').fill('25');
    await ui.viewer.button('Step').click();
    await ui.viewer.waitForTick(tick + 25);
    assert.equal(await settledTick(ui.viewer), tick + 25);
    await ui.viewer.button('Restart').click();
    await ui.viewer.page.waitForFunction(() => Number(document.querySelector('[data-testid=tick]')?.textContent) < 5);
  });

  it('keeps the number of ticks that is being typed while it runs', async () => {
    const ticks = ui.viewer.page.getByLabel('Ticks of a step');
    await ui.viewer.run();
    await ticks.fill('7');
    await ui.viewer.waitForTick((await ui.viewer.tick()) + 150); // the state of the session has come more than once
    assert.equal(await ticks.inputValue(), '7');
    await ticks.press('Enter');
    await ui.viewer.pause();
    const tick = await settledTick(ui.viewer);
    await ui.viewer.button('Step').click();
    await ui.viewer.waitForTick(tick + 7);
    assert.equal(await settledTick(ui.viewer), tick + 7);
  });

  it('confirms the value of a slider', async () => {
    const slider = ui.viewer.parameter('1.amplitude').getByRole('slider').first();
    await slider.focus();
    await ui.viewer.page.keyboard.press('ArrowLeft');
    await ui.viewer.run();
    const values = await confirmedValues(ui.viewer, '1.amplitude', (value) => value !== '40');
    assert.ok(values.every(({ wanted, confirmed, file }) => wanted === confirmed && file === '40' && wanted !== '40'));
  });

  it('confirms a typed value, and rejects one that is out of range', async () => {
    const field = ui.viewer.parameter('1.amplitude').getByRole('textbox');
    await field.fill('33.5');
    await field.press('Enter');
    await confirmedValues(ui.viewer, '1.amplitude', (value) => value === '33.5');
    await field.fill('1000');
    await field.press('Enter');
    const refusal = ui.viewer.parameter('1.amplitude').getByRole('alert');
    await refusal.filter({ hasText: 'found 1000, expected' }).waitFor();
    assert.equal(await field.inputValue(), '1000', 'what was refused stays, to be corrected');
    await field.fill('33.5');
    await field.press('Enter');
    await refusal.waitFor({ state: 'detached' });
    assert.equal(await field.getAttribute('aria-invalid'), 'false');
    // A change by other means ends it, too.
    await field.fill('much');
    await field.press('Tab');
    await refusal.filter({ hasText: "found 'much', expected a number" }).waitFor();
    await ui.viewer.parameter('1.amplitude').getByRole('slider', { name: 'amplitude, all joints' }).press('ArrowUp');
    await refusal.waitFor({ state: 'detached' });
    await field.fill('33.5');
    await field.press('Enter');
    await confirmedValues(ui.viewer, '1.amplitude', (value) => value === '33.5');
  });

  it('changes one joint alone, from the keyboard', async () => {
    const cell = ui.viewer.parameter('1.amplitude').locator('[data-cell="1"]');
    await cell.focus();
    await ui.viewer.page.keyboard.type('20');
    await ui.viewer.page.keyboard.press('Enter');
    const values = await confirmedValues(ui.viewer, '1.amplitude', (value, i) => value === (i === 1 ? '20' : '33.5'));
    assert.equal(values.length, 5);
    assert.equal(await ui.viewer.parameter('1.amplitude').getByRole('textbox').getAttribute('placeholder'), 'several');
  });

  it('undoes and redoes one change at a time', async () => {
    await ui.viewer.page.keyboard.press('Control+z');
    await confirmedValues(ui.viewer, '1.amplitude', (value) => value === '33.5');
    await ui.viewer.page.keyboard.press('Control+y');
    await confirmedValues(ui.viewer, '1.amplitude', (value, i) => value === (i === 1 ? '20' : '33.5'));
  });

  it('shows the command that gives the same run', async () => {
    await ui.viewer.button('Command line').click();
    const command = ui.viewer.page.getByTestId('command');
    await command.filter({ hasText: 'proleg simulate' }).waitFor();
    const text = (await command.textContent()) ?? '';
    assert.match(text, /uniform\.simulation\.xml/);
    assert.match(text, /amplitude(:J\d)?=33\.5/);
    await ui.viewer.screenshot('command_line');
    await ui.viewer.button('Close').click();
  });

  it('goes back to the values of the file', async () => {
    await ui.viewer.parameter('1.amplitude').getByRole('slider').first().dblclick();
    await confirmedValues(ui.viewer, '1.amplitude', (value) => value === '40');
  });

  it('keeps its controls in place when it reports what the servos cannot follow', async () => {
    const frequency = ui.viewer.parameter('1.frequency');
    const slider = frequency.getByRole('slider').first();
    const place = await slider.boundingBox();
    const field = frequency.getByRole('textbox');
    await field.fill('6');
    await field.press('Enter');
    await ui.viewer.page.getByTestId('servo-problem').waitFor();
    assert.deepEqual(await slider.boundingBox(), place);
    await ui.viewer.screenshot('servo_problem');
    await slider.dblclick();
    await confirmedValues(ui.viewer, '1.frequency', (value) => value === '1');
    await ui.viewer.page.getByTestId('servo-problem').waitFor({ state: 'detached' });
    assert.deepEqual(await slider.boundingBox(), place);
  });

  it('has the usual values of a parameter on most of the way of its slider, and all of them from the keyboard', async () => {
    const frequency = ui.viewer.parameter('1.frequency');
    const slider = frequency.getByRole('slider').first();
    await slider.click(); // in the middle, where 10 Hz would be on a straight scale from 0 to 20
    const [middle] = await confirmedValues(ui.viewer, '1.frequency', (value) => value !== '1');
    assert.ok(Number(middle?.wanted) > 0.5 && Number(middle?.wanted) < 2, `found ${middle?.wanted}`);
    await ui.viewer.page.keyboard.press('End');
    await confirmedValues(ui.viewer, '1.frequency', (value) => value === '20');
    await ui.viewer.page.keyboard.press('ArrowLeft');
    await confirmedValues(ui.viewer, '1.frequency', (value) => value === '19.95');
    await slider.dblclick();
    await confirmedValues(ui.viewer, '1.frequency', (value) => value === '1');
  });

  it('says below each name what the parameter changes, until the sentences are hidden', async () => {
    const { page } = ui.viewer;
    const sentence = ui.viewer.parameter('1.phase_difference').getByText('How far the wave runs ahead from joint to joint.', { exact: true });
    await sentence.waitFor();
    await page.setViewportSize({ width: 360, height: 800 });
    await assertNothingIsCut(ui.viewer);
    assert.deepEqual(await seriousProblems(ui.viewer), []);
    await page.getByRole('region', { name: 'Parameters' }).screenshot({ path: 'build/page_test/sentences_360.png' });
    await page.setViewportSize({ width: 1400, height: 900 });
    await ui.viewer.button('Explain').click();
    await sentence.waitFor({ state: 'detached' });
    await page.reload();
    await ui.viewer.parameter('1.phase_difference').waitFor();
    assert.equal(await sentence.count(), 0, 'the browser keeps the choice');
    await ui.viewer.button('Explain').click();
    await sentence.waitFor();
    await ui.viewer.takeControl();
  });

  it('freezes the view while the robot goes on, and returns to live', async () => {
    await ui.viewer.page.getByTestId('scene').focus();
    await ui.viewer.page.keyboard.press('p');
    await ui.viewer.page.getByTestId('frozen').waitFor();
    await ui.viewer.waitForTick((await ui.viewer.tick()) + 30);
    await waitForFrames(ui.viewer.page, 20); // the table is drawn less often than the badge
    const angles = await ui.viewer.angles();
    const first = await ui.viewer.tick();
    // At several times, none of them a whole stride later.
    for (const ticks of [60, 110, 170]) {
      await ui.viewer.waitForTick(first + ticks);
      assert.deepEqual(await ui.viewer.angles(), angles);
    }
    await ui.viewer.page.keyboard.press('l');
    await ui.viewer.page.getByTestId('frozen').waitFor({ state: 'detached' });
    await ui.viewer.waitForOtherAngles(angles);
  });

  it('lights a joint everywhere when it is hovered in the table', async () => {
    const row = ui.viewer.page.locator('[data-testid=joints] tr[data-joint="2"]');
    await row.hover();
    await ui.viewer.parameter('1.amplitude').locator('[data-cell="2"].hovered').waitFor();
    await ui.viewer.page.mouse.move(5, 5);
  });

  it('adds a plot with the lines that are chosen', async () => {
    await ui.viewer.button('Add a plot').click();
    const group = ui.viewer.page.locator('.line-group').nth(1);
    await group.getByLabel('Signal').selectOption('torque');
    await group.getByRole('group', { name: 'Lines of torque' }).getByRole('button').nth(0).click();
    await group.getByRole('group', { name: 'Lines of torque' }).getByRole('button').nth(3).click();
    assert.equal(await group.locator('.line-chips li').count(), 2);
    await group.locator('.line-chips .value').first().filter({ hasText: /\d/ }).waitFor();
    await ui.viewer.screenshot('two_plots');
    await group.getByRole('button', { name: 'Remove this plot' }).click();
    assert.equal(await ui.viewer.page.locator('.line-group').count(), 1);
  });

  it('goes as fast as the computer can', async () => {
    await ui.viewer.button('Fastest').click();
    const tick = await ui.viewer.tick();
    await ui.viewer.waitForTick(tick + 500);
    // The last test: soon the robot has left its ground.
  });
});

// The tick when two looks give the same.
async function settledTick(viewer: Viewer): Promise<number> {
  for (let before = -1; ; ) {
    const now = await viewer.tick();
    if (now === before) {
      return now;
    }
    before = now;
    await waitForFrames(viewer.page, 20);
  }
}

// Waits until each joint's wanted and confirmed values fulfil the condition.
async function confirmedValues(viewer: Viewer, name: string, matches: (value: string, joint: number) => boolean) {
  let values = await viewer.valuesOf(name);
  const isConfirmed = await waitUntil(async () => {
    values = await viewer.valuesOf(name);
    return values.every(({ wanted, confirmed }, joint) => wanted === confirmed && matches(confirmed, joint));
  });
  assert.ok(isConfirmed, `${name}: found ${JSON.stringify(values)}, expected other values that are confirmed`);
  await viewer.waitForConfirmation(name);
  return values;
}
