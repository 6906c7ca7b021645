// Recordings and their exported pages, made by the programs as a user does.
import { execFileSync } from 'node:child_process';
import { program } from './ui_program.js';

// `words`: further options of proleg simulate.
export function record(file: string, scenario: string, ...words: string[]): void {
  execFileSync(program, ['simulate', scenario, '--record', file, ...words], { stdio: ['ignore', 'ignore', 'pipe'] });
}

// The path of the page.
export function exportPage(recording: string): string {
  return execFileSync(program, ['export', recording, '--html'], { encoding: 'utf8' }).split('\n')[0] as string;
}

// The rows of the table of the recording, by the names of its columns.
export function tableOf(recording: string): Record<string, number>[] {
  const lines = execFileSync(program, ['export', recording, '--out', '-'], { encoding: 'utf8', maxBuffer: 2 ** 28 }).trimEnd().split('\n');
  const names = (lines[0] as string).split('\t');
  return lines.slice(1).map((line) => {
    const values = line.split('\t');
    return Object.fromEntries(names.map((name, i) => [name, Number(values[i])]));
  });
}
