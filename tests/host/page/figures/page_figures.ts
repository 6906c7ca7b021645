// Measures the figures of the page and prints them: see tools/page_figures.
import { launchBrowser } from '../browser/support/browser.js';
import type { Bench, Measurement } from './bench.js';
import { sliderToSetpoint, stopToStopped } from './controls.js';
import { besideSimulation, stalledViewer } from './daemon.js';
import { drawing } from './drawing.js';
import { flash } from './flash.js';
import { describeMachine, machineText } from './machine.js';
import { make } from './make.js';
import { summarise, summaryText, type Summary } from './report.js';
import { search } from './search.js';
import { seek } from './seek.js';
import { soak } from './soak.js';
import { sizes, start } from './start.js';
import { bytes, intake } from './telemetry.js';
import { week } from './week.js';

// A new figure is a new entry here.
const measurements: Record<string, Measurement> = {
  slider: sliderToSetpoint,
  stop: stopToStopped,
  drawing,
  make,
  intake,
  bytes,
  stalled: stalledViewer,
  start,
  sizes,
  seek,
  daemon: besideSimulation,
  week,
  search,
  flash,
  soak,
};

interface Options {
  names: string[];
  isJson: boolean;
  soakMinutes: number;
}

function readOptions(words: string[]): Options {
  const options: Options = { names: [], isJson: false, soakMinutes: 5 };
  for (let word = words.shift(); word !== undefined; word = words.shift()) {
    if (word === '--json') {
      options.isJson = true;
    } else if (word === '--soak') {
      options.soakMinutes = Number(words.shift());
    } else if (word in measurements) {
      options.names.push(word);
    } else {
      throw new Error(`found '${word}', expected --json, --soak MINUTES, or one of ${Object.keys(measurements).join(', ')}`);
    }
  }
  if (!(options.soakMinutes >= 0.25 && options.soakMinutes <= 480)) {
    throw new Error(`--soak: found ${options.soakMinutes}, expected 0.25 to 480 minutes`);
  }
  if (options.names.length === 0) {
    options.names = Object.keys(measurements);
  }
  return options;
}

async function main(options: Options): Promise<number> {
  const browser = await launchBrowser();
  const machine = describeMachine(browser);
  const bench: Bench = {
    browser,
    soakMinutes: options.soakMinutes,
    log: (text) => console.error(`  ${text}`),
  };
  if (!options.isJson) {
    console.log(machineText(machine));
  }
  const summaries: Summary[] = [];
  const failures: string[] = [];
  for (const name of options.names) {
    console.error(`== ${name}`);
    try {
      for (const figure of await (measurements[name] as Measurement)(bench)) {
        const summary = summarise(figure);
        summaries.push(summary);
        if (!options.isJson) console.log(summaryText(summary));
      }
    } catch (error) {
      failures.push(`${name}: ${(error as Error).message}`);
      console.error(`page_figures: ${failures.at(-1)}`);
    }
  }
  await browser.close();
  if (options.isJson) {
    console.log(JSON.stringify({ machine, figures: summaries, failures }, null, 2));
  }
  return failures.length === 0 ? 0 : 1;
}

try {
  const options = readOptions(process.argv.slice(2));
  main(options).then(
    (status) => process.exit(status),
    (error: Error) => {
      console.error(`page_figures: ${error.message}`);
      process.exit(1);
    },
  );
} catch (error) {
  console.error(`page_figures: ${(error as Error).message}`);
  process.exit(2);
}
