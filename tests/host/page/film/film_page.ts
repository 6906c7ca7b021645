// The page that draws the pictures of a film, in a browser without a display.
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import type { Browser, Page } from 'playwright-core';
import type { FilmWishes } from '../../../../host/page/source/film/film.js';
import { longest } from '../browser/support/waiting.js';

export class FilmPage {
  private constructor(readonly page: Page) {}

  // `program`: film.js of host/page/bundle.mjs; `exported`: a file of `proleg export --html`. Throws an Error if the film needs
  // more of the recording than there is.
  static async open(browser: Browser, program: string, exported: string, wishes: FilmWishes): Promise<FilmPage> {
    const elements = readFileSync(exported, 'utf8').match(/<script [^>]*(?:id="documents"|class="ticks")[^>]*>[^<]*<\/script>/g) ?? [];
    const folder = mkdtempSync(join(tmpdir(), 'proleg-film-'));
    const file = join(folder, 'film.html');
    const script = `<script>${readFileSync(program, 'utf8')}</script>`;
    writeFileSync(file, `<!doctype html><meta charset="utf-8"><body>${elements.join('\n')}${script}`);
    const page = await browser.newPage();
    page.setDefaultTimeout(longest);
    await page.goto(pathToFileURL(file).href);
    rmSync(folder, { recursive: true });
    await page.evaluate((wanted) => window.beginFilm(wanted), wishes);
    return new FilmPage(page);
  }

  // The picture of a tick as a PNG file.
  async draw(tick: number): Promise<Buffer> {
    const address = await this.page.evaluate((wanted) => window.drawPicture(wanted), tick);
    return Buffer.from(address.split(',')[1] as string, 'base64');
  }
}
