// What most browser tests begin with: a browser for a suite, and in it a viewer of a program, for all tests or for each.
import { after, afterEach, before, beforeEach } from 'node:test';
import type { Browser, BrowserContextOptions } from 'playwright-core';
import { launchBrowser } from './browser.js';
import type { UiProgram } from './ui_program.js';
import { Viewer } from './viewer.js';

interface Served {
  readonly address: string;
  end(): Promise<void>;
}

interface Options {
  isPerTest?: boolean; // a program and a viewer for each test
  takesControl?: boolean;
}

export class UiFixture<Program extends Served> {
  browser!: Browser;
  program!: Program;
  viewer!: Viewer;
  private readonly others: Viewer[] = [];

  constructor(
    private readonly start: () => Promise<Program>,
    private readonly takesControl: boolean,
  ) {}

  async open(): Promise<void> {
    this.program = await this.start();
    this.viewer = await Viewer.open(this.browser, this.program.address);
    if (this.takesControl) await this.viewer.takeControl();
  }

  // Another viewer of the same robot, until the end of the test.
  async look(options: BrowserContextOptions = {}): Promise<Viewer> {
    const viewer = await Viewer.open(this.browser, this.program.address, options);
    this.others.push(viewer);
    return viewer;
  }

  // Fails if a browser has reported an error.
  async closeOthers(): Promise<void> {
    for (const viewer of this.others.splice(0)) await viewer.close();
  }

  async close(): Promise<void> {
    try {
      await this.viewer.close();
    } finally {
      await this.program.end();
    }
  }
}

// To be called in a suite.
export function useUi<Program extends Served = UiProgram>(start: () => Promise<Program>, options: Options = {}): UiFixture<Program> {
  const ui = new UiFixture(start, options.takesControl === true);
  const isPerTest = options.isPerTest === true;
  before(async () => {
    ui.browser = await launchBrowser();
    if (!isPerTest) await ui.open();
  });
  after(async () => {
    try {
      if (!isPerTest) await ui.close();
    } finally {
      await ui.browser.close();
    }
  });
  if (isPerTest) beforeEach(() => ui.open());
  afterEach(async () => {
    try {
      await ui.closeOthers();
    } finally {
      if (isPerTest) await ui.close();
    }
  });
  return ui;
}
