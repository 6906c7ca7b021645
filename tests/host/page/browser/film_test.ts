// The film of a recording (tools/film): what it shows depends on the recording only, and it begins again without a jump.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import type { Browser } from 'playwright-core';
import { FilmPage } from '../film/film_page.js';
import { launchBrowser } from './support/browser.js';
import { countDifferences, pixelsOfPicture } from './support/pixels.js';
import { exportPage, record } from './support/recorded.js';
import { uniform } from './support/ui_program.js';

const program = join(dirname(process.argv[1] as string), '../film.js');
// The shipped caterpillar: 1 Hz, 100 ticks a second.
const wishes = { first: 300, ticks: 100, period: 100, width: 320, height: 180, linesHeight: 40, isDark: true };

describe('the film of a recording', () => {
  let folder: string;
  let browser: Browser;
  let exported: string;

  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'proleg-film-'));
    record(join(folder, 'run.proleg'), uniform, '--seconds', '6');
    exported = exportPage(join(folder, 'run.proleg'));
    browser = await launchBrowser();
  });

  after(async () => {
    await browser.close();
    rmSync(folder, { recursive: true });
  });

  it('moves, and after a period of the gait looks as at its start', async () => {
    const film = await FilmPage.open(browser, program, exported, wishes);
    const draw = async (tick: number) => pixelsOfPicture(film.page, await film.draw(tick));
    const [start, half, end] = [await draw(300), await draw(350), await draw(400)];
    const moved = countDifferences(start, half);
    const changed = countDifferences(start, end);
    assert.ok(moved > 3000, `found ${moved} different pixels, expected a robot that moves`);
    // The robot has nearly settled: edges may be drawn a pixel aside.
    assert.ok(changed < moved / 5, `found ${changed} different pixels after a period, ${moved} after half of it, expected few`);
  });

  it('is the same each time', async () => {
    const draw = async () => (await FilmPage.open(browser, program, exported, wishes)).draw(320);
    assert.ok((await draw()).equals(await draw()));
  });

  it('is refused if the recording is too short', async () => {
    const far = { ...wishes, first: 550 };
    await assert.rejects(
      FilmPage.open(browser, program, exported, far),
      /found a recording from 0 s to 5.99 s, expected one from 5 s to 7 s: half a period more than the film at each end/,
    );
  });
});
