// What a tile, and the answers to actions of a class, say in words.
import type { ClassDocument, ClassSeat, CollectResult } from '../wire/class_messages.js';
import type { TileSession } from './tile_messages.js';

export interface TileState {
  text: string;
  kind: 'running' | 'paused' | 'stopped' | 'starting' | 'absent';
}

const robotStates: Record<TileSession['state'], TileState> = {
  running: { text: 'runs', kind: 'running' },
  paused: { text: 'paused', kind: 'paused' },
  stopped: { text: 'STOPPED', kind: 'stopped' },
  failed: { text: 'failed', kind: 'stopped' },
  off: { text: 'power off', kind: 'paused' },
  starting: { text: 'starting', kind: 'starting' },
  held: { text: 'holds', kind: 'running' },
  stopping: { text: 'stops', kind: 'starting' },
};

// `session`: null: nothing is known of the robot yet.
export function tileState({ seat, state, connections }: ClassSeat, session: TileSession | null): TileState {
  if (state === 'starting') return { text: 'starting', kind: 'starting' };
  if (state === 'ended') return { text: 'ended', kind: 'stopped' };
  const robot = session === null ? null : robotStates[session.state];
  // The teacher's own page is open only now and then.
  if (connections === 0 && seat !== 0) {
    const isTold = robot?.kind === 'running' || robot?.kind === 'stopped'; // after a STOP the teacher sees that it has reached all
    return isTold ? { text: `not there, robot ${robot.text}`, kind: robot.kind } : { text: 'not there', kind: 'absent' };
  }
  return robot ?? { text: 'connecting', kind: 'starting' };
}

export function speedText(speed: number | null | undefined): string {
  return typeof speed === 'number' ? `${(speed * 1000).toFixed(0)} mm/s` : '–';
}

export function distanceText(distance: number | null | undefined): string {
  return typeof distance === 'number' ? `${distance.toFixed(2)} m` : '–';
}

// The most important thing that is wrong; null: nothing is.
export function tileProblem({ problem, state }: ClassSeat, session: TileSession | null): string | null {
  if (state === 'ended') return problem ?? 'The program of this robot does not run.';
  return session?.failure ?? session?.servoProblem ?? null;
}

export function countText({ learners, limit }: Pick<ClassDocument, 'learners' | 'limit'>): string {
  const present = learners.filter(({ state, connections }) => state !== 'ended' && connections > 0).length;
  return `${learners.length} of ${limit} learners, ${present} there`;
}

// "482 913" is read aloud more easily.
export function codeText(code: string): string {
  return code.replace(/^(\d{3})(\d{3})$/, '$1 $2');
}

// Whether only browsers on this computer reach the address.
export function isOnlyHere(address: string): boolean {
  return /^https?:\/\/(127\.0\.0\.1|localhost|\[::1\])[:/]/.test(address);
}

export function linkForLearners({ address, code }: Pick<ClassDocument, 'address' | 'code'>): string {
  return `${address}#join=${code}`;
}

// "7 recordings copied, 3 were there, 1 still runs".
export function collectText({ copied, known, running }: CollectResult): string {
  if (copied + known + running === 0) return 'There are no recordings yet.';
  const parts = [copied === 1 ? '1 recording copied' : `${copied} recordings copied`];
  if (known > 0) parts.push(known === 1 ? '1 was there' : `${known} were there`);
  if (running > 0) parts.push(running === 1 ? '1 still runs' : `${running} still run`);
  return `${parts.join(', ')}.`;
}

// The address at which the teacher opens a robot. `page`: one of the pages that an address may name.
export function seatAddress({ seat, path, token }: ClassSeat, page: string | null = null): string {
  return `${path}${seat === 0 ? '' : '?look'}#${token}${page === null ? '' : `&${page}`}`;
}
