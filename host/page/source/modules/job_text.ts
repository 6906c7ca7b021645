// A job with modules in words.
import type { JobKind, ModuleJob, ModuleWait } from '../wire/messages.js';

const titles: Record<JobKind, string> = {
  scan: 'Scan',
  examine: 'What is wrong?',
  save: 'Save settings',
  compare: 'Compare settings',
  load: 'Load settings',
  assign: 'Places',
  calibrate: 'Calibrate',
  flash: 'Flash',
  recover: 'Recover',
};

export function jobTitle(kind: JobKind): string {
  return titles[kind] ?? kind;
}

export function isRunning(job: ModuleJob | null): boolean {
  return job !== null && job.state !== 'ended';
}

function isDryRun(result: unknown): boolean {
  return typeof result === 'object' && result !== null && (result as { dry_run?: unknown }).dry_run === true;
}

// Jobs that only read say with status 1 that they have found something.
const findsWithStatus1: readonly JobKind[] = ['scan', 'examine', 'compare'];

export function jobState(job: ModuleJob): { text: string; tone: 'good' | 'quiet' | 'bad' } {
  if (job.state === 'running') return { text: job.question === null ? 'runs' : 'waits for an answer', tone: 'quiet' };
  if (job.state === 'ending') return { text: 'ends', tone: 'quiet' };
  if (job.ended_by !== null) return { text: `ended early: ${job.ended_by}`, tone: 'bad' };
  if (job.status === 0) return { text: 'done', tone: 'good' };
  if (job.status === 1 && findsWithStatus1.includes(job.kind) && job.result !== null) return { text: 'done', tone: 'good' };
  if (job.status === null) return { text: 'ended by a signal', tone: 'bad' };
  if (job.status !== 1 || job.result === null) return { text: 'failed', tone: 'bad' };
  return isDryRun(job.result) ? { text: 'done, nothing was changed', tone: 'quiet' } : { text: 'ended: not all is well', tone: 'bad' };
}

// The wait of a `recover` for modules that are silent; null: it does not wait now.
export function waitOf(job: ModuleJob | null): ModuleWait | null {
  const wait = job !== null && job.kind === 'recover' && isRunning(job) ? job.latest.waits : undefined;
  return wait === undefined || wait.left_s <= 0 ? null : wait;
}

export function waitText({ left_s: left, seen }: ModuleWait): { text: string; left: string } {
  return { text: seen === 0 ? 'no module was seen yet' : `${seen} ${seen === 1 ? 'module was' : 'modules were'} seen`, left: `${Math.ceil(left)} s left` };
}

// The word of an answer for what a person has typed: the name of a joint, whatever its case, or what the program knows.
export function placeWord(typed: string, joints: readonly { name: string }[]): string {
  const text = typed.trim();
  return joints.find(({ name }) => name.toLowerCase() === text.toLowerCase())?.name ?? text;
}

// A value as the programs take it: with a decimal point.
export function valueWord(typed: string): string {
  const text = typed.trim();
  return /^[+-]?\d*,\d+$/.test(text) ? text.replace(',', '.') : text;
}

// "2000" of "2000 mA"; "0x1" of "0x1 (1)".
export function valueWithoutUnit(value: string): string {
  return /^[^\s(]+(?=\s)/.exec(value)?.[0] ?? value;
}

// "mA" of "2000 mA"; nothing of "0x1 (1)".
export function unitOf(value: string): string {
  return /^\S+\s+([^\s(]\S*)$/.exec(value)?.[1] ?? '';
}

// A number of a field, or the reason why it is none.
export function numberIn(typed: string, lowest: number, highest: number): number | string {
  const value = Number(valueWord(typed));
  const isGood = typed.trim() !== '' && Number.isFinite(value) && value >= lowest && value <= highest;
  return isGood ? value : `found '${typed}', expected a number from ${lowest} to ${highest}`;
}
