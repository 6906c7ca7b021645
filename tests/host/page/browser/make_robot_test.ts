// The page Make: a robot, its gait and its world without a file and without a shell. What it saves is what the command line
// reads, and what a person writes by hand.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, describe, it } from 'node:test';
import type { Page } from 'playwright-core';
import { seriousProblems } from './support/accessibility.js';
import { assertNothingIsCut } from './support/layout.js';
import { useUi } from './support/ui_fixture.js';
import { program, UiProgram } from './support/ui_program.js';
import { waitUntil } from './support/waiting.js';

function hashes(file: string, seconds: string): { setpoint: string; servo: string } {
  const json = execFileSync(program, ['simulate', file, '--seconds', seconds, '--json'], { encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] });
  const result = JSON.parse(json) as { setpoint_hash: string; servo_hash: string };
  return { setpoint: result.setpoint_hash, servo: result.servo_hash };
}

// Everything that the program reads from a scenario, without where it stands: two files can say the same in other words.
function contents(file: string): unknown {
  const script = 'tests/host/page/browser/support/scenario_contents.py';
  const json = execFileSync('python3', [script, program, file], { encoding: 'utf8', maxBuffer: 64 * 1024 * 1024 });
  const places = new Set(['file', 'line', 'group', 'same']);
  return JSON.parse(json, (name, value: unknown) =>
    places.has(name) ? undefined : typeof value === 'number' ? Math.round(value * 1e9) / 1e9 : value,
  );
}

// Waits for a step of the panel New.
async function atStep(page: Page, step: string): Promise<void> {
  await page.getByTestId('new-panel').locator('[aria-current=step]', { hasText: step }).waitFor();
}

describe('a new robot', () => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-page-'));
  const ui = useUi(() => UiProgram.serve(['--recordings', folder]), { isPerTest: true, takesControl: true });
  after(() => rmSync(folder, { recursive: true }));

  // The saved files, simulated by the command line as long as the page has run, give the same bits.
  async function assertSameRun(file: string): Promise<void> {
    const { page } = ui.viewer;
    await page.getByRole('navigation').locator('[aria-current=page]', { hasText: 'Live' }).waitFor();
    await page.keyboard.press('Escape'); // pauses
    await page.getByTestId('state').filter({ hasText: 'paused' }).waitFor();
    const shownCommand = async () => {
      await page.keyboard.press('x');
      await page.getByTestId('setpoint-hash').waitFor();
      return (await page.getByTestId('command').textContent()) ?? '';
    };
    let command = await shownCommand();
    for (; /--seconds 0(?![.\d])/.test(command); command = await shownCommand()) {
      // It was paused before its first tick.
      await page.keyboard.press('Escape');
      await page.keyboard.press('.');
    }
    assert.ok(command.includes(file), command);
    const seconds = /--seconds ([\d.]+)/.exec(command)?.[1] as string;
    assert.ok(Number(seconds) > 0, command);
    assert.deepEqual(
      { setpoint: await page.getByTestId('setpoint-hash').textContent(), servo: await page.getByTestId('servo-hash').textContent() },
      hashes(file, seconds),
    );
    await page.keyboard.press('Escape');
  }

  it('crawls after at most 12 clicks', async () => {
    const { page } = ui.viewer;
    let clicks = 0;
    const click = async (role: 'button' | 'radio' | 'link', name: string | RegExp) => {
      clicks += 1;
      await page.getByRole(role, { name, exact: typeof name === 'string' }).first().click();
    };
    await click('button', /^Make/);
    await click('button', 'New …');
    await click('radio', /^snake/);
    await click('button', 'a joint less');
    await click('button', 'Next');
    await click('button', 'Next');
    await click('radio', /^hills/);
    await click('button', 'Next');
    await page.getByRole('textbox', { name: 'name of the robot and of its folder' }).fill('viper');
    await click('button', 'Create and start');
    assert.ok(clicks <= 12, `${clicks} clicks`);
    const file = join(folder, 'viper/robot.simulation.xml');
    assert.ok(await waitUntil(() => Promise.resolve(existsSync(file))));
    await assertSameRun(file);
    const robot = readFileSync(join(folder, 'viper/robot.robot.xml'), 'utf8');
    assert.equal(robot.match(/<Joint /g)?.length, 7);
    assert.match(robot, /<Robot name="viper">/);
    assert.match(readFileSync(join(folder, 'viper/flat.environment.xml'), 'utf8'), /hills/);
  });

  it('is made with the keyboard alone, too', async () => {
    const { page } = ui.viewer;
    const focus = async (name: string | RegExp) => {
      for (let i = 0; i < 120; i++) {
        await page.keyboard.press('Tab');
        const text = await page.evaluate(() => {
          const element = document.activeElement as HTMLElement | null;
          return element?.getAttribute('aria-label') ?? element?.closest('label')?.textContent ?? element?.textContent ?? '';
        });
        if (typeof name === 'string' ? text.trim() === name : name.test(text.trim())) return;
      }
      assert.fail(`Tab does not come to ${name}`);
    };
    await page.keyboard.press('3');
    await page.getByTestId('draft-file').waitFor();
    await page.keyboard.press('n');
    await page.getByTestId('new-panel').waitFor();
    await focus(/^caterpillar/);
    await page.keyboard.press('ArrowDown');
    await page.getByText('CUBO').first().waitFor();
    for (const step of ['2. gait', '3. world', '4. name']) {
      await focus('Next');
      await page.keyboard.press('Enter');
      await atStep(page, step);
    }
    await focus('name of the robot and of its folder');
    await page.keyboard.type('cubes');
    await page.keyboard.press('Enter');
    const file = join(folder, 'cubes/robot.simulation.xml');
    assert.ok(await waitUntil(() => Promise.resolve(existsSync(file))));
    await assertSameRun(file);
    assert.match(readFileSync(join(folder, 'cubes/robot.robot.xml'), 'utf8'), /CUBO/);
  });

  it('is at the same step when control was given up and taken again', async () => {
    const { page } = ui.viewer;
    await page.keyboard.press('3');
    await page.getByTestId('draft-file').waitFor();
    await page.keyboard.press('n');
    for (let i = 0; i < 2; i++) await page.getByRole('button', { name: 'Next' }).click();
    await atStep(page, '3. world');
    await ui.viewer.lookOn();
    await page.getByTestId('new-panel').getByText('Take control first').waitFor();
    assert.ok(await page.getByRole('button', { name: 'Next' }).isDisabled());
    await ui.viewer.takeControl();
    await page.getByTestId('new-panel').getByText('Take control first').waitFor({ state: 'detached' });
    await page.getByRole('button', { name: 'Next' }).click();
    await atStep(page, '4. name');
  });

  it('says which name is taken, and writes nothing', async () => {
    const { page } = ui.viewer;
    mkdirSync(join(folder, 'taken'));
    await page.keyboard.press('3');
    await page.getByTestId('draft-file').waitFor();
    await page.keyboard.press('n');
    for (let i = 0; i < 3; i++) await page.getByRole('button', { name: 'Next' }).click();
    await page.getByRole('textbox', { name: 'name of the robot and of its folder' }).fill('taken');
    await page.getByRole('button', { name: 'Create and start' }).click();
    await page.getByTestId('new-panel').getByRole('alert').filter({ hasText: 'a folder that exists' }).waitFor();
    await page.getByRole('textbox', { name: 'name of the robot and of its folder' }).fill('../out');
    await page.getByRole('button', { name: 'Create and start' }).click();
    await page.getByTestId('new-panel').getByRole('alert').filter({ hasText: "without '/'" }).waitFor();
  });
});

describe('robot and behaviour', () => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-page-'));
  const ui = useUi(() => UiProgram.serve(['--recordings', folder]), { takesControl: true });
  after(() => rmSync(folder, { recursive: true }));

  const page = () => ui.viewer.page;
  const tab = (name: string) => page().getByRole('tab', { name });
  const chain = () => page().getByTestId('chain');
  const matrix = () => page().getByTestId('matrix');
  const axes = async () => (await chain().locator('tbody td').allTextContents()).join('');
  const joint = (name: string) => chain().getByRole('button', { name, exact: true });
  const field = (region: string, name: string) => page().getByRole('region', { name: region }).getByRole('textbox', { name, exact: true });
  const fill = async (region: string, name: string, value: string) => {
    await field(region, name).fill(value);
    await field(region, name).press('Enter');
  };
  const cell = (module: number, name: string) => matrix().getByRole('button', { name: `module ${module} moves ${name}`, exact: true });

  it('shows the chain from the tail to the head', async () => {
    await page().keyboard.press('3');
    await tab('Robot').click();
    assert.ok(await waitUntil(async () => (await axes()) === 'ppppp'), await axes());
    assert.deepEqual(await chain().locator('thead button').allTextContents(), ['J1', 'J2', 'J3', 'J4', 'J5']);
  });

  it('grows to eight joints, py in turn', async () => {
    for (const name of ['J2', 'J4']) {
      await chain().getByRole('button', { name: `axis of ${name}: pitch: up and down` }).click();
    }
    assert.ok(await waitUntil(async () => (await axes()) === 'pypyp'), await axes());
    await fill('Chain', 'joints', '8');
    assert.ok(await waitUntil(async () => (await axes()) === 'pypypypy'), await axes());
  });

  it('changes values of several joints at once, and says what cannot be', async () => {
    await joint('J1').click();
    await joint('J8').click({ modifiers: ['Shift'] });
    await fill('Chosen joints', 'highest angle in °', '60,5');
    await joint('J8').click();
    assert.ok(await waitUntil(async () => (await field('Chosen joints', 'highest angle in °').inputValue()) === '60.5'));
    await fill('Chosen joints', 'lowest angle in °', '10');
    await page().getByRole('region', { name: 'Chosen joints' }).getByRole('alert').filter({ hasText: 'include 0' }).waitFor();
    await fill('Chosen joints', 'lowest angle in °', '-90');
  });

  it('removes, copies, moves and reverses joints; undo brings each back', async () => {
    await joint('J3').click();
    await page().getByTestId('map-top').focus();
    await page().keyboard.press('Delete');
    assert.ok(await waitUntil(async () => (await axes()) === 'pyypypy'), await axes());
    await page().keyboard.press('Control+z');
    assert.ok(await waitUntil(async () => (await axes()) === 'pypypypy'), await axes());
    await joint('J2').click();
    await page().getByRole('button', { name: 'Add a copy' }).click();
    assert.ok(await waitUntil(async () => (await axes()) === 'pyypypypy'), await axes());
    await page().keyboard.press('Control+z');
    assert.ok(await waitUntil(async () => (await axes()) === 'pypypypy'), await axes());
    await joint('J1').click();
    await page().getByRole('button', { name: 'to the head →' }).click();
    assert.ok(await waitUntil(async () => (await axes()) === 'yppypypy'), await axes());
    await page().keyboard.press('Control+z');
    assert.ok(await waitUntil(async () => (await axes()) === 'pypypypy'), await axes());
    await page().getByRole('button', { name: 'Reverse' }).click();
    assert.ok(await waitUntil(async () => (await axes()) === 'ypypypyp'), await axes());
    await page().keyboard.press('Control+z');
    assert.ok(await waitUntil(async () => (await axes()) === 'pypypypy'), await axes());
  });

  it('gets sensors', async () => {
    const sensors = page().getByRole('region', { name: 'Sensors' });
    await sensors.getByRole('button', { name: 'Add sensor' }).click();
    await sensors.getByRole('button', { name: 'touch', exact: true }).click();
    await sensors.getByRole('combobox', { name: 'the gait feels it' }).selectOption('front');
    await sensors.getByRole('combobox', { name: 'new', exact: true }).selectOption('Inclinometer');
    await sensors.getByRole('button', { name: 'Add sensor' }).click();
    await sensors.getByRole('button', { name: 'level', exact: true }).waitFor();
  });

  it('has three overlapping groups, made by clicks and drags', async () => {
    await tab('Behaviour').click();
    await page().getByText('Add a gait or a reflex').click();
    const add = (name: string) => page().getByRole('region', { name: 'Behaviour' }).locator('.add-module').getByRole('button', { name, exact: true }).click();
    await add('sinusoidal');
    await cell(2, 'J1').waitFor();
    // All joints at first: a drag from J5 to J8 takes them out.
    await cell(2, 'J5').hover();
    await page().mouse.down();
    for (const name of ['J6', 'J7', 'J8']) await cell(2, name).hover();
    await page().mouse.up();
    assert.ok(await waitUntil(async () => (await cell(2, 'J8').getAttribute('aria-pressed')) === 'false'));
    for (const [name, isOn] of [['J4', 'true'], ['J5', 'false'], ['J6', 'false'], ['J7', 'false']] as const) {
      assert.equal(await cell(2, name).getAttribute('aria-pressed'), isOn, name);
    }
    await page().keyboard.press('Control+z');
    assert.ok(await waitUntil(async () => (await cell(2, 'J5').getAttribute('aria-pressed')) === 'true'), 'a drag is one entry of undo');
    await page().keyboard.press('Control+y');
    assert.ok(await waitUntil(async () => (await cell(2, 'J5').getAttribute('aria-pressed')) === 'false'));
    await add('DirectJointAccess');
    await cell(3, 'J3').waitFor();
    for (const name of ['J1', 'J2', 'J8']) await cell(3, name).click();
    assert.ok(await waitUntil(async () => (await matrix().locator('.sum td').allTextContents()).join(' ') === 'Σ 2 Σ 2 Σ 3 Σ 3 Σ 2 Σ 2 Σ 2 1'), (await matrix().locator('.sum td').allTextContents()).join(' '));
  });

  it('sets parameters for all joints of a module, and for one', async () => {
    await matrix().getByRole('button', { name: /^2\. sinusoidal/ }).click();
    await fill('Module 2', 'amplitude in deg', '12,5');
    const row = page().locator('[data-parameter=amplitude]');
    await row.getByRole('button', { name: 'each joint' }).click();
    assert.ok(await waitUntil(async () => (await field('Module 2', 'J4').inputValue()) === '12.5'));
    await fill('Module 2', 'J4', '20');
    assert.ok(await waitUntil(async () => (await field('Module 2', 'amplitude in deg').getAttribute('placeholder')) === 'several'));
    await fill('Module 2', 'J4', '2000');
    await page().getByRole('region', { name: 'Module 2' }).getByRole('alert').filter({ hasText: '2000' }).waitFor();
  });

  it('shows the next half minute while a slider is dragged; the drag is one entry of undo', async () => {
    const foresight = async () => (await page().getByTestId('foresight').textContent()) ?? '';
    const slider = page().locator('[data-parameter=frequency]').getByRole('slider');
    const before = { value: await field('Module 2', 'frequency in Hz').inputValue(), foresight: await foresight() };
    await slider.scrollIntoViewIfNeeded();
    const box = (await slider.boundingBox())!;
    await page().mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page().mouse.down();
    await page().mouse.move(box.x + box.width * 0.8, box.y + box.height / 2, { steps: 12 });
    const isNew = await waitUntil(async () => (await foresight()) !== before.foresight && !/computing/.test(await foresight()));
    await page().screenshot({ path: 'build/page_test/make_slider.png' });
    assert.ok(isNew, await foresight());
    await page().mouse.up();
    assert.ok(await waitUntil(async () => Number(await field('Module 2', 'frequency in Hz').inputValue()) > Number(before.value)));
    await page().getByTestId('map-top').focus();
    await page().keyboard.press('Control+z');
    assert.ok(await waitUntil(async () => (await field('Module 2', 'frequency in Hz').inputValue()) === before.value));
  });

  it('stands before stairs, a ramp, a height field and a box that moves', async () => {
    await tab('World').click();
    for (const item of ['stairs', 'ramp', 'rough ground', 'box']) {
      await page().getByRole('region', { name: 'Library' }).getByRole('button', { name: item, exact: true }).click();
      if (item === 'rough ground') {
        for (const side of ['width', 'length']) {
          const number = page().getByRole('form', { name: 'New rough ground' }).getByRole('textbox', { name: `${side} in m`, exact: true });
          await number.fill('0,3');
          await number.press('Tab');
        }
      }
      await page().getByRole('button', { name: `Add ${item}` }).click();
      await page().getByRole('region', { name: 'Objects' }).getByRole('button', { name: item, exact: true, pressed: true }).waitFor();
    }
    await page().getByLabel('moves when something pushes it').check();
    await fill('Objects', 'mass in kg', '0,2');
    // Dragged in the drawing from above, then to an exact place.
    const before = await field('Objects', 'y in m').inputValue();
    const object = page().getByTestId('map-top').locator('[data-name=box] polygon').first();
    await object.hover();
    const box = (await object.boundingBox())!;
    await page().mouse.down();
    await page().mouse.move(box.x + box.width / 2 + 40, box.y + box.height / 2 + 30, { steps: 5 });
    await page().mouse.up();
    assert.ok(await waitUntil(async () => (await field('Objects', 'y in m').inputValue()) !== before));
    await fill('Objects', 'x in m', '0,25');
    await fill('Objects', 'y in m', '3,4');
    assert.ok(await waitUntil(async () => (await field('Objects', 'y in m').inputValue()) === '3.4'));
  });

  for (const [name, width] of [['Robot', 1366], ['Behaviour', 1366], ['Robot', 600], ['Robot', 360], ['Behaviour', 360]] as const) {
    it(`has a part ${name} that fits a window ${width} pixels wide, and screen readers`, async () => {
      await page().setViewportSize({ width, height: 800 });
      await tab(name).click();
      await assertNothingIsCut(ui.viewer);
      assert.deepEqual(await seriousProblems(ui.viewer), []);
      await page().screenshot({ path: `build/page_test/make_${name}_${width}.png`, fullPage: true });
    });
  }

  it('is saved as the files that a person would write', async () => {
    await page().setViewportSize({ width: 1366, height: 800 });
    await page().keyboard.press('Control+s');
    await page().getByPlaceholder('its name').fill('eight');
    await page().getByRole('button', { name: 'Save a copy' }).click();
    const file = join(folder, 'eight/robot.simulation.xml');
    await page().getByRole('list', { name: 'Notices' }).getByText('saved as').waitFor(); // all files of it
    const byHand = 'tests/host/page/browser/by_hand/eight.simulation.xml';
    assert.deepEqual(contents(file), contents(byHand));
    assert.deepEqual(hashes(file, '5'), hashes(byHand, '5'));
  });
});
