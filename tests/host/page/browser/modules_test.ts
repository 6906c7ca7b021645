// The page Modules: a box of modules becomes a robot, with clicks.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { cpSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import type { Page } from 'playwright-core';
import { seriousProblems } from './support/accessibility.js';
import { launchBrowser } from './support/browser.js';
import { BusProgram } from './support/bus_program.js';
import { assertNothingIsCut } from './support/layout.js';
import { useUi } from './support/ui_fixture.js';
import { program, slowTime, UiProgram } from './support/ui_program.js';
import { Viewer } from './support/viewer.js';
import { waitForFrames, waitUntil } from './support/waiting.js';

const slot = 0x08020200; // where the program of a module begins
const tasks = ['Module', 'Places', 'Flash', 'Recover', 'Settings', 'What is wrong?'];

// A project with a scenario and an image whose body looks like a program.
function makeProject(): string {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-page-'));
  cpSync('sim/scenarios/travelling_wave', join(folder, 'mine'), { recursive: true });
  const body = new Uint32Array(3500).map((_, i) => (i === 0 ? 0x20000800 : i === 1 ? slot + 0x201 : Math.imul(i, 2654435761)));
  const raw = join(folder, 'body.bin');
  writeFileSync(raw, new Uint8Array(body.buffer));
  const image = ['--board', '1', '--address', `0x${slot.toString(16)}`, '--version', '0.2.0', '--protocol', '0x0100', '--fingerprint', '12345678', '--schema', '2'];
  execFileSync(program, ['image', 'make', raw, '--output', join(folder, 'new.pimg'), ...image], { stdio: 'ignore' });
  return folder;
}

const hexSerial = (serial: number) => `0x${serial.toString(16).toUpperCase().padStart(8, '0')}`;

// What a user does on the page Modules.
class ModulesPage {
  constructor(private readonly get: () => Page) {}

  get page(): Page {
    return this.get();
  }

  async show(): Promise<void> {
    await this.page.getByRole('button', { name: 'Modules', exact: true }).click();
    await this.page.getByTestId('modules-bus').waitFor();
  }

  async open(address: string): Promise<void> {
    await this.show();
    await this.page.getByLabel('another address').fill(address);
    await this.page.getByRole('button', { name: 'Open', exact: true }).click();
    await this.page.getByTestId('bus-state').getByText('open').waitFor();
  }

  rows() {
    return this.page.getByTestId('modules').locator('tbody tr');
  }

  async task(name: string): Promise<void> {
    await this.page.getByRole('tab', { name, exact: true }).click();
  }

  button(name: string | RegExp) {
    const panel = this.page.locator('#modules-task');
    return typeof name === 'string' ? panel.getByRole('button', { name, exact: true }) : panel.getByRole('button', { name });
  }

  async jobState(): Promise<string> {
    const job = this.page.getByTestId('job');
    return `${(await job.locator('h2').textContent()) ?? ''}: ${(await job.getByTestId('job-state').textContent()) ?? ''}`;
  }

  async waitForJob(expected: RegExp): Promise<void> {
    assert.ok(await waitUntil(async () => expected.test(await this.jobState())), await this.page.locator('body').innerText());
  }

  async screenshot(name: string): Promise<void> {
    await this.page.screenshot({ path: `build/page_test/modules_${name}.png`, fullPage: true });
  }
}

describe('a box of modules', () => {
  const folder = makeProject();
  const scenario = join(folder, 'mine/uniform.simulation.xml');
  // Places end when nobody drives for a second: a reload on a busy computer takes longer.
  const ui = useUi(() => UiProgram.serve([scenario, '--paused', '--recordings', folder], slowTime), { takesControl: true });
  const modules = new ModulesPage(() => ui.viewer.page);
  const page = () => ui.viewer.page;
  let bus!: BusProgram;
  let wanted!: Map<number, number>; // serial numbers by the node ids of the robot's file

  before(async () => {
    const ordered = await BusProgram.start();
    wanted = ordered.serials();
    await ordered.end();
    bus = await BusProgram.start(['--shuffle', '7', '--fresh', '2']);
  });

  after(async () => {
    await bus.end();
    rmSync(folder, { recursive: true, maxRetries: 20, retryDelay: 100 });
  });

  const question = () => page().getByTestId('place-question');
  const answer = (name: string) => page().getByRole('list', { name: 'Joints, from the head to the tail' }).getByRole('button', { name, exact: true });
  const nextQuestion = async (serial: string | null) => {
    const isOther = async () => (await answer('J1').isEnabled()) && (serial === null || !((await question().textContent()) ?? '').includes(serial));
    assert.ok(await waitUntil(isOther), await page().locator('body').innerText());
    return /0x[0-9A-F]{8}/.exec((await question().textContent()) ?? '')?.[0] as string;
  };

  it('is not found at an address where nothing listens, and the page says why', async () => {
    await modules.show();
    await page().getByLabel('another address').fill('tcp:127.0.0.1:1');
    await page().getByRole('button', { name: 'What is wrong?', exact: true }).last().click();
    await page().getByTestId('findings').locator('li').first().waitFor();
    assert.equal(await page().getByTestId('findings').locator('li').count(), 1);
    await modules.screenshot('no_bus');
  });

  it('is found on a bus that is opened, with modules that have no node id', async () => {
    await modules.open(bus.address);
    assert.ok(await waitUntil(async () => (await modules.rows().count()) === 4), String(await modules.rows().count()));
    await page().getByTestId('fresh-modules').waitFor();
    for (const [node, serial] of bus.serials()) {
      await page().getByTestId('modules').locator(`tr[data-node="${node}"]`).getByText(hexSerial(serial)).waitFor();
    }
    await modules.screenshot('found');
  });

  it('does not put the bus into the place of the simulation', async () => {
    await page().locator('.badge').getByText('SIMULATION', { exact: true }).waitFor();
    assert.equal(await page().getByRole('button', { name: /^STOP/ }).isVisible(), true);
  });

  it('shows the objects of a module, and writes one', async () => {
    await page().getByTestId('modules').getByRole('button', { name: '3', exact: true }).click();
    const speed = page().getByTestId('objects').locator('tr[data-object="0x6080"]');
    await speed.getByText('720 deg/s').waitFor();
    await speed.getByText('greatest speed').waitFor();
    await speed.getByRole('button', { name: 'Change Max motor speed' }).click();
    await speed.getByRole('textbox').fill('300');
    await speed.getByRole('button', { name: 'Write' }).click();
    await speed.getByText('300 deg/s').waitFor();
    assert.match(bus.ask('get', '3', '0x6080'), /300 deg\/s/);
    await page().getByLabel('all objects').check();
    await page().getByTestId('objects').locator('tr[data-object="0x1000"]').waitFor();
    await page().getByLabel('find', { exact: true }).fill('over-current');
    const found = () => page().getByTestId('objects').locator('tr[data-object]').allTextContents();
    assert.ok(await waitUntil(async () => (await found()).every((row) => /over-current/i.test(row))), (await found()).join('; '));
    assert.ok((await found()).length > 1);
    await page().getByLabel('find', { exact: true }).fill('');
  });

  it('lights the touch sensors that are pressed, and gives those that were never released no tick', async () => {
    // The robot lies on the ground.
    assert.ok(await waitUntil(async () => (await page().locator('.touch-dots .pressed').count()) > 0), 'a pressed sensor');
    const sensors = page().getByTestId('touch-test').locator('li');
    assert.ok((await sensors.count()) >= 2);
    await page().getByTestId('touch-test').getByText('Pressed since the test began').waitFor();
    assert.equal(await sensors.filter({ hasText: '✓' }).count(), 0);
    await modules.screenshot('module');
  });

  it('begins a calibration, and leaves it without a change', async () => {
    await modules.button('Calibrate …').click();
    const view = page().getByTestId('calibration');
    await view.getByText('Turn the joint by hand to −90°').waitFor();
    await view.getByTestId('reading').waitFor();
    await view.getByRole('button', { name: 'Here' }).click();
    await view.getByText('Turn the joint by hand to +90°').waitFor();
    await modules.screenshot('calibration');
    assert.equal(await modules.button('Calibrate …').isDisabled(), true);
    await view.getByRole('button', { name: 'End' }).click();
    await view.getByText('Nothing is stored.').waitFor();
    await view.getByRole('button', { name: 'Close' }).click();
  });

  it('keeps settings in a file, compares them, and loads them', async () => {
    await modules.task('Settings');
    await modules.button('Save').click();
    await modules.waitForJob(/^Save settings: done/);
    assert.match(readFileSync(join(folder, 'table.params'), 'utf8'), /3\t0x6080\t300/);
    bus.ask('set', '3', '0x6080', '400');
    assert.ok(await waitUntil(() => modules.button('Compare').isEnabled()));
    await modules.button('Compare').click();
    const row = page().getByTestId('differences').locator('tbody tr');
    await row.first().waitFor();
    assert.deepEqual((await row.first().locator('th, td').allTextContents()).slice(3), ['400 deg/s', '300 deg/s']);
    await modules.screenshot('settings');
    await modules.button('Load').click();
    await modules.waitForJob(/^Load settings: done/);
    assert.match(bus.ask('get', '3', '0x6080'), /300 deg\/s/);
    await modules.button('Compare').click();
    await page().getByText('No difference.').waitFor();
  });

  it('gets its places: by a click in the list, by digits, in the picture; a reload loses nothing', async () => {
    await modules.task('Places');
    await modules.button('Find the places').click();
    const first = await nextQuestion(null);
    await answer(await bus.movingJoint()).click();
    const second = await nextQuestion(first);
    await modules.button('Larger motion').click();
    assert.ok(await waitUntil(async () => /by 10°/.test((await question().textContent()) ?? '')), (await question().textContent()) ?? '');
    await page().keyboard.press('9'); // not page 9, and no joint
    await page().keyboard.press('Enter');
    await page().locator('#modules-task').getByRole('alert').waitFor();
    await page().reload();
    assert.equal(new URL(page().url()).hash, '#modules');
    assert.equal(await nextQuestion(null), second);
    await page().keyboard.press((await bus.movingJoint()).slice(1));
    await page().keyboard.press('Enter');
    const third = await nextQuestion(second);
    await clickInPicture(await bus.movingJoint());
    let asked = await nextQuestion(third);
    await modules.screenshot('places');
    assert.deepEqual(await seriousProblems(ui.viewer), []);
    await answer(await bus.movingJoint()).click();
    asked = await nextQuestion(asked);
    await answer(await bus.movingJoint()).click();
    const agreement = page().getByTestId('agreement');
    await agreement.getByRole('table').waitFor();
    await modules.screenshot('agreement');
    await agreement.getByRole('button', { name: 'Give them these node ids' }).click();
    await modules.waitForJob(/^Places: done/);
    await page().getByText('Each joint has its module.').waitFor();
    assert.deepEqual(bus.serials(), wanted);
    assert.ok(await waitUntil(async () => (await modules.rows().count()) === 5), 'the new module is in the table');
    await page().getByTestId('fresh-modules').waitFor({ state: 'detached' });
  });

  // Where a joint is shown says the list, in which the one under the pointer is lit.
  async function clickInPicture(name: string): Promise<void> {
    const scene = page().locator('.places').getByTestId('scene');
    const box = await scene.boundingBox();
    assert.ok(box !== null);
    const lit = page().locator('.place-list li.hovered button');
    for (let down = 0.3; down < 0.9; down += 0.06) {
      for (let right = 0.25; right < 0.8; right += 0.04) {
        await page().mouse.move(box.x + right * box.width, box.y + down * box.height);
        await waitForFrames(page(), 20); // until the worker has looked
        if ((await lit.allTextContents()).join() === name) {
          await page().mouse.down();
          await page().mouse.up();
          return;
        }
      }
    }
    assert.fail(`${name} is not in the picture`);
  }

  it('is stopped by Esc while joints move, also beside a simulation', async () => {
    await modules.button('Find the places').click();
    await nextQuestion(null);
    await bus.movingJoint();
    await page().keyboard.press('Escape');
    await modules.waitForJob(/^Places: ended early: STOP/);
    assert.ok(await waitUntil(() => bus.powered === null), 'no joint has power');
  });

  it('gets another program: first it says what would be done, then each module has a bar', async () => {
    await modules.task('Flash');
    assert.ok(await waitUntil(() => modules.button('Look what would be done').isEnabled()));
    await modules.button('Look what would be done').click();
    const verdicts = page().getByTestId('verdicts');
    await modules.waitForJob(/^Flash: done/);
    assert.equal(await verdicts.locator('tbody tr').count(), 5);
    assert.ok(await waitUntil(() => modules.button('Flash all modules').isEnabled()));
    await modules.button('Flash all modules').click();
    await verdicts.getByRole('progressbar').first().waitFor();
    await modules.screenshot('flash');
    await modules.waitForJob(/^Flash: done/);
    assert.equal(await verdicts.getByText('✓ runs the image').count(), 5);
    assert.equal(await verdicts.locator('td:last-child', { hasText: '0.2.0' }).count(), 5);
  });

  it('shows the command of a job, and its lines', async () => {
    await page().getByTestId('job').locator('summary').click();
    await page().getByTestId('job').getByText(`proleg flash`).first().waitFor();
    assert.match((await page().getByTestId('job').locator('code').textContent()) ?? '', new RegExp(`--canary --bus ${bus.address}`));
  });

  it('refuses an older image, and says why; the options that force it are at hand', async () => {
    const old = join(folder, 'old.pimg');
    const words = ['--board', '1', '--address', `0x${slot.toString(16)}`, '--version', '0.1.0', '--protocol', '0x0100', '--fingerprint', '12345678', '--schema', '2'];
    execFileSync(program, ['image', 'make', join(folder, 'body.bin'), '--output', old, ...words], { stdio: 'ignore' });
    await modules.button('Look again').click();
    await page().locator('#modules-task select').selectOption('old.pimg');
    assert.ok(await waitUntil(() => modules.button('Look what would be done').isEnabled()));
    await modules.button('Look what would be done').click();
    assert.ok(await waitUntil(async () => (await page().getByTestId('verdicts').getByText('REFUSED').count()) === 5));
    await page().getByText('5 modules are refused').waitFor();
    await page().getByText('Modules that are refused', { exact: true }).click();
    await page().getByLabel('also if the image is older').check();
    assert.ok(await waitUntil(() => modules.button('Look what would be done').isEnabled()));
    await modules.button('Look what would be done').click();
    assert.ok(await waitUntil(async () => (await page().getByTestId('verdicts').getByText('REFUSED').count()) === 0));
  });

  it('says what is wrong', async () => {
    await modules.task('What is wrong?');
    assert.ok(await waitUntil(() => modules.button('Look').isEnabled()));
    await modules.button('Look').click();
    await page().getByTestId('findings').waitFor();
    await modules.button('Look again').waitFor();
    await modules.screenshot('findings');
  });

  it('is only shown to those who do not drive', async () => {
    const other = await ui.look();
    const theirs = new ModulesPage(() => other.page);
    await theirs.show();
    assert.ok(await waitUntil(async () => (await theirs.rows().count()) === 5));
    await theirs.task('Flash');
    assert.equal(await theirs.button('Flash all modules').getAttribute('title'), 'Take control first (C).');
    assert.equal(await theirs.button('Flash all modules').isDisabled(), true);
    assert.equal(await other.page.getByRole('button', { name: 'Close', exact: true }).isDisabled(), true);
  });

  for (const width of [1366, 1024, 390]) {
    it(`fits a window ${width} pixels wide, and screen readers, light and dark`, async () => {
      await page().getByTestId('modules').getByRole('button', { name: '3', exact: true }).click();
      for (const colours of ['light', 'dark'] as const) {
        await ui.viewer.lookAs({ name: '', width, colours });
        for (const task of tasks) {
          await modules.task(task);
          await assertNothingIsCut(ui.viewer);
          assert.deepEqual(await seriousProblems(ui.viewer), [], task);
        }
      }
      await modules.task('Module');
      await modules.screenshot(String(width));
      await page().getByTestId('modules').getByRole('button', { name: '3', exact: true }).click();
    });
  }

  it('closes the bus', async () => {
    await page().getByRole('button', { name: 'Close', exact: true }).click();
    await page().getByRole('heading', { name: 'Open a bus' }).waitFor();
    assert.equal(await page().getByTestId('modules').count(), 0);
  });

  it('says why a bus cannot be opened', async () => {
    await page().getByLabel('another address').fill('tcp:127.0.0.1:1');
    await page().getByRole('button', { name: 'Open', exact: true }).click();
    await page().getByRole('list', { name: 'Notices' }).getByText(/127\.0\.0\.1:1/).waitFor();
    assert.ok(existsSync(folder));
  });
});

describe('modules that do not come back', () => {
  const folder = makeProject();
  const ui = useUi(() => UiProgram.start(join(folder, 'mine/uniform.simulation.xml'), ['--recordings', folder]), { takesControl: true });
  const modules = new ModulesPage(() => ui.viewer.page);
  const page = () => ui.viewer.page;
  let bus!: BusProgram;

  before(async () => {
    bus = await BusProgram.start(['--broken', '3=no-program', '--broken', '5=duplicate:4']);
  });

  after(async () => {
    await bus.end();
    rmSync(folder, { recursive: true, maxRetries: 20, retryDelay: 100 });
  });

  it('are looked at first, then brought back', async () => {
    await modules.open(bus.address);
    await modules.task('Recover');
    assert.ok(await waitUntil(() => modules.button('Look what is wrong').isEnabled()));
    assert.equal(await modules.button('Recover').getAttribute('title'), 'Look what is wrong first.');
    await modules.button('Look what is wrong').click();
    const table = page().getByTestId('recovery');
    await modules.waitForJob(/^Recover: done, nothing was changed/);
    await table.getByText('has no program').waitFor();
    assert.equal(await table.getByText('has the same node id as another module').count(), 2);
    await modules.screenshot('recover');
    assert.ok(await waitUntil(() => modules.button('Recover').isEnabled()));
    await modules.button('Recover').click();
    await modules.waitForJob(/^Recover: done/);
    await page().getByText('All modules are well.').waitFor();
    assert.equal(await table.locator('td.good').count(), 5);
    assert.equal(bus.serials().size, 5);
  });
});

describe('a module that answers nothing', () => {
  const folder = makeProject();
  const ui = useUi(() => UiProgram.start(join(folder, 'mine/uniform.simulation.xml'), ['--recordings', folder]), { takesControl: true });
  const modules = new ModulesPage(() => ui.viewer.page);
  let bus!: BusProgram;

  before(async () => {
    bus = await BusProgram.start(['--broken', '3=silent']);
  });

  after(async () => {
    await bus.end();
    rmSync(folder, { recursive: true, maxRetries: 20, retryDelay: 100 });
  });

  it('is found when a person switches the supply off and on at the time at which the page asks for it', async () => {
    const { page } = ui.viewer;
    await modules.open(bus.address);
    await modules.task('Recover');
    const wait = page.getByTestId('recover-wait');
    const table = page.getByTestId('recovery');
    await page.getByLabel('look for, in seconds').fill('12');
    assert.equal(await wait.count(), 0);
    assert.ok(await waitUntil(() => modules.button('Look what is wrong').isEnabled()));
    await modules.button('Look what is wrong').click();
    await wait.getByText('switch the robot’s supply off and on now').waitFor();
    assert.match((await wait.textContent()) ?? '', /\d+ s left/);
    bus.switchSupply('off');
    await wait.getByText('seen').waitFor();
    bus.switchSupply('on');
    await modules.screenshot('recover_wait');
    await modules.waitForJob(/^Recover: done, nothing was changed/);
    await table.getByText('has answered nothing until the supply was switched off and on').waitFor();
    assert.equal(await wait.count(), 0);
  });
});

describe('a project without a robot', () => {
  const folder = makeProject();
  let bus!: BusProgram;

  before(async () => {
    bus = await BusProgram.start();
  });

  after(async () => {
    await bus.end();
    rmSync(folder, { recursive: true, maxRetries: 20, retryDelay: 100 });
  });

  it('has STOP as soon as a bus is open; without a scenario there are no places', async () => {
    const browser = await launchBrowser();
    const ui = await UiProgram.serve([folder]);
    const viewer = await Viewer.openAny(browser, ui.address);
    try {
      await viewer.takeControl();
      const modules = new ModulesPage(() => viewer.page);
      await modules.show();
      const stop = viewer.page.getByRole('button', { name: /^STOP/ });
      assert.equal(await stop.count(), 0);
      await modules.open(bus.address);
      await stop.waitFor();
      await modules.task('Places');
      await viewer.page.getByText('Open a scenario first').waitFor();
      assert.equal(await modules.button('Find the places').isDisabled(), true);
      await viewer.page.reload();
      await viewer.page.getByTestId('modules').waitFor();
    } finally {
      await viewer.close();
      await ui.end();
      await browser.close();
    }
  });
});

describe('the modules of a robot on a bus', () => {
  const ui = useUi(() => UiProgram.startOnBus(), { takesControl: true });
  const modules = new ModulesPage(() => ui.viewer.page);

  it('are on the bus with which the program was started; nothing is possible while servos have power', async () => {
    const { page } = ui.viewer;
    await modules.show();
    await page.getByText('Proleg was started with this bus.').waitFor();
    assert.ok(await waitUntil(async () => (await modules.rows().count()) === 5));
    assert.ok(await waitUntil(() => page.getByRole('button', { name: 'Scan', exact: true }).isEnabled()));
    await page.keyboard.press('o');
    const scan = page.getByRole('button', { name: 'Scan', exact: true });
    assert.ok(await waitUntil(async () => /Power off first/.test((await scan.getAttribute('title')) ?? '')));
    assert.equal(await scan.isDisabled(), true);
    await page.keyboard.press('Shift+o');
    assert.ok(await waitUntil(() => scan.isEnabled()));
  });
});
