// The order of the tiles of a class.
import type { ClassSeat } from '../wire/class_messages.js';

export const orders = { name: 'name', seat: 'seat', speed: 'speed, the fastest first' } as const;
export type Order = keyof typeof orders;

// `speeds`: m/s by seat; robots without one come last.
export function inOrder(learners: readonly ClassSeat[], order: Order, speeds: ReadonlyMap<number, number | null>): ClassSeat[] {
  const bySeat = [...learners].sort((a, b) => a.seat - b.seat);
  if (order === 'name') {
    return bySeat.sort((a, b) => a.name.localeCompare(b.name, undefined, { numeric: true, sensitivity: 'base' }));
  }
  if (order === 'speed') {
    const speedOf = ({ seat }: ClassSeat) => speeds.get(seat) ?? -1;
    return bySeat.sort((a, b) => speedOf(b) - speedOf(a));
  }
  return bySeat;
}
