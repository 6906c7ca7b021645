// The name of this viewer for others: in a class that of the person, else the browser, the system, and a number, since many
// have the same.

export const personKey = 'proleg.name'; // in the session storage: the entry of a class writes it

const browsers: readonly [RegExp, string][] = [
  [/Edg\//, 'Edge'],
  [/Firefox\//, 'Firefox'],
  [/Chrome\//, 'Chrome'],
  [/Safari\//, 'Safari'],
];

const systems: readonly [RegExp, string][] = [
  [/Android/, 'Android'],
  [/iPhone|iPad/, 'iOS'],
  [/Windows/, 'Windows'],
  [/Mac OS X/, 'macOS'],
  [/Linux/, 'Linux'],
];

// number: 1 to 999.
export function viewerName(userAgent: string, number: number): string {
  const find = (table: readonly [RegExp, string][]) => table.find(([pattern]) => pattern.test(userAgent))?.[1];
  return `${find(browsers) ?? 'A browser'} on ${find(systems) ?? 'another system'} #${number}`;
}

// The number of this page, which a reload keeps.
export function viewerNumber(storage: Pick<Storage, 'getItem' | 'setItem'>): number {
  const key = 'viewer';
  const kept = Number(storage.getItem(key));
  if (Number.isInteger(kept) && kept > 0 && kept < 1000) {
    return kept;
  }
  const number = 1 + Math.floor(Math.random() * 999);
  storage.setItem(key, String(number));
  return number;
}

// The name of the person in a class; null: it is not known. `onlyLooks`: the teacher looks at the robot of a learner.
export function personName(onlyLooks: boolean, storage: Pick<Storage, 'getItem'>): string | null {
  return onlyLooks ? 'Teacher' : storage.getItem(personKey);
}
