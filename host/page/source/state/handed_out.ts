// Which scenario of the teacher a person has not seen yet.
import type { HandedOut } from '../wire/messages.js';

const keyOf = (path: string) => `proleg.handed_out${path}`;

// The file of the last one that was opened or dismissed in this tab; null: none. (Each has a folder of its own. A program that
// starts again counts from 1 again, so numbers do not tell them apart.) `path`: of the seat.
export function readSeen(path: string, storage: Pick<Storage, 'getItem'>): string | null {
  return storage.getItem(keyOf(path));
}

export function storeSeen(path: string, file: string, storage: Pick<Storage, 'setItem'>): void {
  storage.setItem(keyOf(path), file);
}

// Who has seen one needs no band for those before it.
export function newestUnseen(handedOut: readonly HandedOut[], seen: string | null): HandedOut | null {
  const newest = handedOut.at(-1);
  return newest !== undefined && newest.file !== seen ? newest : null;
}
