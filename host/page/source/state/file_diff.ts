// The choice of the differences between the page's values and the file that are to be written.
import type { FileDiff, FileDiffEntry } from '../wire/messages.js';

export interface FileGroup {
  file: string;
  numbers: number[]; // positions of the entries of the diff in the list
}

export function groupByFile(entries: readonly FileDiffEntry[]): FileGroup[] {
  const groups = new Map<string, number[]>();
  entries.forEach((entry, i) => groups.set(entry.file, [...(groups.get(entry.file) ?? []), i]));
  return [...groups].map(([file, numbers]) => ({ file, numbers }));
}

// The identity of an entry, which stays the same when the values change again.
export function keyOf(entry: FileDiffEntry): string {
  return `${entry.slot}.${entry.name}:${entry.joints.join()}`;
}

// The entries that are to be written: all but those that were left out, by their keys.
export function chosenNumbers(diff: FileDiff, leftOut: ReadonlySet<string>): number[] {
  return diff.entries.flatMap((entry, i) => (leftOut.has(keyOf(entry)) ? [] : [i]));
}

// The text for the joints of an entry. `names`: names of all joints; `group`: the joints of the slot.
export function jointsText(entry: FileDiffEntry, names: readonly string[], group: readonly number[]): string {
  if (entry.joints.length === group.length) {
    return 'all joints';
  }
  return entry.joints.map((joint) => names[joint] ?? `joint ${joint + 1}`).join(', ');
}
