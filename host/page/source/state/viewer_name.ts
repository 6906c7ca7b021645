// The name of this viewer for others: the browser, the system, and a number, since many have the same.

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
