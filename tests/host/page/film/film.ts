// Makes a film of a recording: see tools/film.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { launchBrowser } from '../browser/support/browser.js';
import { FilmPage } from './film_page.js';

const pause = 50; // milliseconds from picture to picture
const quality = 66; // of 100

interface Options {
  exported: string;
  out: string;
  from: number; // seconds
  seconds: number;
  period: number;
  isDark: boolean;
}

// tools/film gives all of them, in this order.
function readOptions([exported, out, from, seconds, period, theme]: string[]): Options {
  const number = (name: string, text: string | undefined, least: number) => {
    const value = Number(text);
    if (!(value >= least && value <= 3600)) throw new Error(`${name}: found '${text}', expected ${least} to 3600 seconds`);
    return value;
  };
  return {
    exported: exported as string,
    out: out as string,
    from: number('--from', from, 0),
    seconds: number('--seconds', seconds, 0.1),
    period: number('--period', period, 0.02),
    isDark: theme !== 'light',
  };
}

function ticksPerSecond(exported: string): number {
  const text = /<script [^>]*id="documents"[^>]*>([^<]*)<\/script>/.exec(readFileSync(exported, 'utf8'))?.[1] ?? '{}';
  return 1e6 / (JSON.parse(text) as { telemetry: { tick_us: number } }).telemetry.tick_us;
}

async function main(words: string[]): Promise<void> {
  const { exported, out, from, seconds, period, isDark } = readOptions(words);
  const rate = ticksPerSecond(exported);
  const ticks = (length: number) => Math.round(length * rate);
  const wishes = { first: ticks(from), ticks: ticks(seconds), period: ticks(period), width: 800, height: 400, linesHeight: 112, isDark };
  const folder = mkdtempSync(join(tmpdir(), 'proleg-film-'));
  const browser = await launchBrowser();
  try {
    const film = await FilmPage.open(browser, join(dirname(process.argv[1] as string), '../film.js'), exported, wishes);
    const pictures: string[] = [];
    for (let at = 0; at < wishes.ticks; at = ticks((pictures.length * pause) / 1000)) {
      const file = join(folder, `${String(pictures.length).padStart(5, '0')}.png`);
      writeFileSync(file, await film.draw(wishes.first + at));
      pictures.push(file);
    }
    try {
      const look = ['-loop', '0', '-lossy', '-q', String(quality), '-m', '6', '-d', String(pause)];
      execFileSync('img2webp', [...look, ...pictures, '-o', out], { stdio: 'ignore' });
    } catch {
      throw new Error(`${out}: img2webp could not write it`);
    }
    console.log(`${out}: ${pictures.length} pictures, ${Math.ceil(statSync(out).size / 1024)} KiB`);
  } finally {
    await browser.close();
    rmSync(folder, { recursive: true });
  }
}

main(process.argv.slice(2)).catch((error: Error) => {
  // Of what a page throws only the text is for a person.
  console.error(`tools/film: ${error.message.replace(/^page\.evaluate: Error: /, '').split('\n')[0]}`);
  process.exit(2);
});
