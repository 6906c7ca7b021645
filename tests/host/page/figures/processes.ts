// What the kernel says about a process.
import { readdirSync, readFileSync } from 'node:fs';

// Processor time of each thread, in milliseconds. The first is the main thread.
export function threadTimes(pid: number): number[] {
  return readdirSync(`/proc/${pid}/task`)
    .map(Number)
    .sort((a, b) => a - b)
    .map((thread) => Number(readFileSync(`/proc/${pid}/task/${thread}/schedstat`, 'utf8').split(' ')[0]) / 1e6);
}

export const sum = (values: readonly number[]) => values.reduce((total, value) => total + value, 0);

// What follows the name in /proc/PID/stat: it may have spaces.
const statOf = (pid: number) => readFileSync(`/proc/${pid}/stat`, 'utf8').split(') ').at(-1)!.split(' ');

// Processor time of all its threads, also of those that have ended, in milliseconds.
export function processorTime(pid: number): number {
  const [user, system] = statOf(pid).slice(11, 13).map(Number);
  return 10 * ((user as number) + (system as number));
}

// Processes that another one has started, and those that these have started, whose command has this word.
export function descendants(pid: number, word: string): number[] {
  const parents = new Map<number, number>();
  for (const name of readdirSync('/proc').filter((entry) => /^\d+$/.test(entry))) {
    try {
      parents.set(Number(name), Number(statOf(Number(name))[1]));
    } catch {
      // It has ended since.
    }
  }
  const isBelow = (process: number): boolean => {
    const parent = parents.get(process);
    return parent !== undefined && (parent === pid || isBelow(parent));
  };
  return [...parents.keys()].filter((process) => isBelow(process) && readFileSync(`/proc/${process}/cmdline`, 'utf8').includes(word));
}

// In KiB. `VmRSS`: present; `VmHWM`: the largest so far.
export function residentMemory(pid: number, field: 'VmRSS' | 'VmHWM' = 'VmRSS'): number {
  const status = readFileSync(`/proc/${pid}/status`, 'utf8');
  const found = new RegExp(`^${field}:\\s+(\\d+) kB`, 'm').exec(status);
  if (found === null) {
    throw new Error(`found no ${field} of process ${pid}, expected a process that runs`);
  }
  return Number(found[1]);
}

// Bytes that the process behind this port of the loopback has sent and the other end has not taken from the kernel.
export function unsentBytes(localPort: number, remotePort: number): number {
  const hex = (port: number) => port.toString(16).toUpperCase().padStart(4, '0');
  for (const line of readFileSync('/proc/net/tcp', 'utf8').split('\n').slice(1)) {
    const [, local, remote, , queues] = line.trim().split(/\s+/);
    if (local?.endsWith(`:${hex(localPort)}`) === true && remote?.endsWith(`:${hex(remotePort)}`) === true) {
      return parseInt((queues as string).split(':')[0] as string, 16);
    }
  }
  throw new Error(`found no connection from port ${localPort} to port ${remotePort}`);
}

const patience = 60000; // milliseconds

// Rejects if the promise takes too long. `what`: it is a promise of this.
export async function inTime<T>(promise: Promise<T>, what: string): Promise<T> {
  let timer: NodeJS.Timeout | undefined;
  const late = new Promise<never>((_, reject) => {
    timer = setTimeout(() => reject(new Error(`found nothing in ${patience / 1000} s, expected ${what}`)), patience);
  });
  return Promise.race([promise, late]).finally(() => clearTimeout(timer));
}

export const sleep = (ms: number) => new Promise<void>((resolve) => setTimeout(resolve, ms));
