// A viewer of the page in a browser context of its own, with the words of a user: take control, run, read the table.
import assert from 'node:assert/strict';
import type { Browser, BrowserContext, BrowserContextOptions, Page } from 'playwright-core';
import { longest } from './waiting.js';

const screenshots = 'build/page_test';
// A page may also read a part of itself ahead of its use, when the program has just ended.
export const lostConnection = /WebSocket connection .* failed|Failed to load resource: net::ERR_CONNECTION_REFUSED/;

export interface Look {
  name: string;
  width: number; // pixels
  colours: 'light' | 'dark';
}

export class Viewer {
  // What the browser reported as an error or a warning, scripts that failed too.
  readonly reports: string[] = [];
  // Patterns of reports that a test provokes. SwiftShader is slow at reading pixels, and says so.
  readonly expected: RegExp[] = [/GPU stall due to ReadPixels/];

  private constructor(
    readonly page: Page,
    private readonly context: BrowserContext,
  ) {}

  // A robot, or a recording. `before`: runs in the page before its scripts.
  static async open(
    browser: Browser,
    address: string,
    options: BrowserContextOptions = {},
    before: () => void = () => {},
  ): Promise<Viewer> {
    const viewer = await Viewer.goTo(browser, address, options, before);
    await viewer.page.getByTestId('scene').waitFor();
    await viewer.page.getByTestId('joints').locator('tbody tr').first().waitFor();
    return viewer;
  }

  // A folder with recordings.
  static async openList(browser: Browser, address: string): Promise<Viewer> {
    const viewer = await Viewer.goTo(browser, address, {}, () => {});
    await viewer.page.getByTestId('recordings').waitFor();
    return viewer;
  }

  // Whatever the program shows.
  static async openAny(browser: Browser, address: string): Promise<Viewer> {
    const viewer = await Viewer.goTo(browser, address, {}, () => {});
    await viewer.page.getByTestId('control').waitFor();
    return viewer;
  }

  // A page without a robot, such as the entry of a class.
  static openPage(browser: Browser, address: string, options: BrowserContextOptions = {}): Promise<Viewer> {
    return Viewer.goTo(browser, address, options, () => {});
  }

  // Another tab, which a link has opened.
  static of(page: Page): Viewer {
    return new Viewer(page, page.context());
  }

  private static async goTo(
    browser: Browser,
    address: string,
    options: BrowserContextOptions,
    before: () => void,
  ): Promise<Viewer> {
    const context = await browser.newContext({ viewport: { width: 1400, height: 900 }, ...options });
    context.setDefaultTimeout(longest);
    context.setDefaultNavigationTimeout(longest);
    await context.addInitScript(before);
    const viewer = new Viewer(await context.newPage(), context);
    viewer.page.on('console', (message) => {
      if (['error', 'warning'].includes(message.type())) viewer.reports.push(message.text());
    });
    viewer.page.on('pageerror', (error) => viewer.reports.push(error.message));
    await viewer.page.goto(address);
    return viewer;
  }

  async close(): Promise<void> {
    await this.context.close();
    assert.deepEqual(this.reports.filter((report) => !this.expected.some((pattern) => pattern.test(report))), []);
  }

  // The window and the colours that the system asks for.
  async lookAs({ width, colours }: Look): Promise<void> {
    await this.page.setViewportSize({ width, height: 900 });
    await this.page.emulateMedia({ colorScheme: colours });
    await this.page.waitForFunction((theme) => document.documentElement.dataset['theme'] === theme, colours);
  }

  async screenshot(name: string): Promise<void> {
    await this.page.screenshot({ path: `${screenshots}/${name}.png` });
  }

  button(name: string | RegExp) {
    return typeof name === 'string'
      ? this.page.getByRole('button', { name, exact: true })
      : this.page.getByRole('button', { name });
  }

  // Unless this viewer has it.
  async takeControl(): Promise<void> {
    const take = this.button(/^(Take|Ask for) control$/);
    const release = this.button('Release');
    await take.or(release).waitFor();
    if (await take.isVisible()) await take.click();
    await release.waitFor();
  }

  // Gives control up if this viewer has it. The only viewer of a robot on this computer has it from the start.
  async lookOn(): Promise<void> {
    const take = this.button(/^(Take|Ask for) control$/);
    const release = this.button('Release');
    await take.or(release).waitFor();
    if (await release.isVisible()) await release.click();
    await take.waitFor();
  }

  async run(): Promise<void> {
    await this.button('Run').click();
    await this.waitForState('running');
  }

  async pause(): Promise<void> {
    await this.button('Pause').click();
    await this.waitForState('paused');
  }

  async waitForState(state: string): Promise<void> {
    try {
      await this.page.getByTestId('state').getByText(state, { exact: true }).waitFor();
    } catch (error) {
      throw new Error(`${String(error)}\nthe page: ${await this.page.locator('body').innerText()}`);
    }
  }

  async tick(): Promise<number> {
    return Number(await this.page.getByTestId('tick').textContent());
  }

  async waitForTick(tick: number): Promise<void> {
    await this.page.waitForFunction((least) => Number(document.querySelector('[data-testid=tick]')?.textContent) >= least, tick);
  }

  // Degrees, from the table of joints.
  async angles(): Promise<number[]> {
    const texts = await this.page.locator('[data-testid=joints] td[data-value=angle]').allTextContents();
    return texts.map(Number);
  }

  async waitForOtherAngles(angles: number[]): Promise<void> {
    const selector = '[data-testid=joints] td[data-value=angle]';
    await this.page.waitForFunction(
      ([cells, before]) =>
        [...document.querySelectorAll(cells)].map((cell) => Number(cell.textContent)).join() !== before,
      [selector, angles.join()] as const,
    );
  }

  // Metres.
  async head(): Promise<[number, number, number]> {
    const text = (await this.page.getByTestId('head').textContent()) ?? '';
    const numbers = [...text.matchAll(/-?\d+\.\d+/g)].map(Number);
    assert.equal(numbers.length, 3, `found the position '${text}', expected three numbers`);
    return numbers as [number, number, number];
  }

  // The report of the last STOP. On a busy computer POST is answered before the socket: the report is then without the
  // numbers of modules until they come, so it is complete only with them.
  async stopReport(complete = /\d+ of \d+ confirmed|not confirmed/): Promise<string> {
    const report = this.page.getByTestId('stop-report');
    await report.filter({ hasText: complete }).waitFor();
    return (await report.textContent()) ?? '';
  }

  parameter(name: string) {
    return this.page.locator(`[data-parameter="${name}"]`);
  }

  async waitForConfirmation(name: string): Promise<void> {
    await this.page.getByTestId(`confirmed-${name}`).filter({ hasText: '✓' }).waitFor();
  }

  // Raw values of a document's parameter cannot be seen; this is what the page shows as wanted and confirmed.
  async valuesOf(name: string): Promise<{ wanted: string; confirmed: string; file: string }[]> {
    const titles = await this.parameter(name)
      .locator('[data-cell]')
      .evaluateAll((cells) => cells.map((cell) => cell.getAttribute('title') ?? ''));
    return titles.map((title) => {
      const match = /wanted (\S+), confirmed (\S+), file (\S+)/.exec(title);
      assert.ok(match, `found the title '${title}', expected three values`);
      return { wanted: match[1] as string, confirmed: match[2] as string, file: match[3] as string };
    });
  }

  // The main thread hangs until the returned function is called: it waits for an answer that this process holds back.
  async hang(): Promise<() => Promise<void>> {
    const address = '**/held_back';
    let goOn = () => {};
    const released = new Promise<void>((resolve) => (goOn = resolve));
    let answered = Promise.resolve();
    const hangs = new Promise<void>((resolve) => {
      void this.page.route(address, (route) => {
        answered = released.then(() => route.fulfill({ status: 204 }));
        resolve();
        return answered;
      });
    });
    await this.page.evaluate(() => {
      setTimeout(() => {
        const request = new XMLHttpRequest();
        request.open('GET', '/held_back', false);
        request.send();
      }, 0);
    });
    await hangs;
    return async () => {
      goOn();
      await answered;
      await this.page.unroute(address);
    };
  }
}
