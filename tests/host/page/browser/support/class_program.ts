// Starts `proleg ui --class` with a new folder, and has what learners and the teacher do at its pages.
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import type { Browser, BrowserContextOptions } from 'playwright-core';
import { slowTime, UiProgram } from './ui_program.js';
import { lostConnection, Viewer } from './viewer.js';
import { waitUntil } from './waiting.js';

const refusedRequest = /Failed to load resource: the server responded with a status of (4\d\d|503)/;

export class ClassProgram {
  private constructor(
    readonly folder: string,
    private readonly program: UiProgram,
  ) {}

  static async start(learners: number): Promise<ClassProgram> {
    const folder = mkdtempSync(join(tmpdir(), 'proleg-class-'));
    return new ClassProgram(folder, await UiProgram.serve(['--class', String(learners), '--recordings', folder], slowTime));
  }

  async end(): Promise<void> {
    await this.program.end();
    rmSync(this.folder, { recursive: true, maxRetries: 20, retryDelay: 100 });
  }

  // Of the teacher's page.
  get address(): string {
    return this.program.address;
  }

  get entry(): string {
    return this.address.replace(/#.*/, '');
  }

  get code(): string {
    return (JSON.parse(readFileSync(join(this.folder, 'class.json'), 'utf8')) as { code: string }).code;
  }

  get wrongCode(): string {
    return this.code === '000000' ? '000001' : '000000';
  }
}

// A person of the class, in a browser context of his or her own.
export class Learner {
  private constructor(readonly viewer: Viewer) {}

  static async at(browser: Browser, address: string, options: BrowserContextOptions = {}): Promise<Learner> {
    const viewer = await Viewer.openPage(browser, address, options);
    viewer.expected.push(refusedRequest, lostConnection);
    viewer.page.on('dialog', () => assert.fail('found a dialog of the browser, expected none'));
    return new Learner(viewer);
  }

  get page() {
    return this.viewer.page;
  }

  // `code`: null: the link has it.
  async write(name: string, code: string | null): Promise<void> {
    await this.page.getByLabel('Your name').fill(name);
    if (code !== null) await this.page.getByLabel(/^Code/).fill(code);
    await this.viewer.button('Go').click();
  }

  async join(name: string, code: string | null): Promise<void> {
    await this.write(name, code);
    await this.waitForRobot(name);
  }

  async waitForRobot(name: string): Promise<void> {
    await this.page.getByTestId('person').getByText(name, { exact: true }).waitFor();
    await this.page.getByTestId('joints').locator('tbody tr').first().waitFor();
  }

  // The line at a field of the entry, which has the focus then.
  async problem(field: 'name' | 'code' | 'button', expected: RegExp): Promise<void> {
    const line = this.page.locator(`#problem-${field}`);
    await line.filter({ hasText: expected }).waitFor();
    assert.equal(((await line.textContent()) ?? '').includes('\n'), false);
    if (field !== 'button') await this.page.locator(`#entry-${field}:focus`).waitFor();
  }

  seat(): string {
    return new URL(this.page.url()).pathname;
  }

  async setAmplitude(value: string): Promise<void> {
    const field = this.viewer.parameter('1.amplitude').getByRole('textbox').first();
    await field.fill(value);
    await field.press('Enter');
    const isConfirmed = async () => {
      const values = await this.viewer.valuesOf('1.amplitude');
      return values.length > 0 && values.every(({ wanted, confirmed }) => wanted === value && confirmed === value);
    };
    assert.ok(await waitUntil(isConfirmed));
  }

  async amplitude(): Promise<string> {
    return (await this.viewer.valuesOf('1.amplitude'))[0]?.wanted ?? '';
  }
}

export class Teacher {
  private constructor(readonly viewer: Viewer) {}

  static async at(browser: Browser, address: string): Promise<Teacher> {
    const viewer = await Viewer.openPage(browser, address);
    viewer.expected.push(lostConnection);
    await viewer.page.getByTestId('code').waitFor();
    return new Teacher(viewer);
  }

  get page() {
    return this.viewer.page;
  }

  tile(name: string) {
    return this.page.locator('.tile').filter({ has: this.page.getByRole('heading', { name, exact: true }) });
  }

  async waitForState(name: string, state: string | RegExp): Promise<void> {
    await this.tile(name).getByTestId('tile-state').getByText(state, { exact: true }).waitFor();
  }

  dialog() {
    return this.page.getByRole('dialog');
  }

  // The page of a robot, in the new tab that its tile opens.
  async open(name: string): Promise<Viewer> {
    const opened = this.page.context().waitForEvent('page');
    await this.tile(name).getByRole('link', { name: /Open$/ }).click();
    return Viewer.of(await opened);
  }

  // One of the actions that ask back.
  async act(name: string, action: string): Promise<void> {
    await this.tile(name).getByRole('button', { name: /More$/ }).click();
    await this.dialog().getByRole('button', { name: `${action} …`, exact: true }).click();
    await this.dialog().getByRole('button', { name: action, exact: true }).click();
    await this.dialog().waitFor({ state: 'detached' });
  }
}
