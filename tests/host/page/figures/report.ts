// Figures of the page, and how they are printed.

export interface Figure {
  name: string;
  unit: string;
  wanted: { median?: number; p99?: number; least?: boolean }; // limits; `least`: they are lower limits
  conditions: string;
  samples: number[];
}

// The smallest sample that at least this share of all samples does not exceed (nearest rank).
export function quantile(samples: readonly number[], share: number): number {
  const sorted = [...samples].sort((a, b) => a - b);
  return sorted[Math.max(0, Math.ceil(share * sorted.length) - 1)] as number;
}

export interface Summary {
  name: string;
  unit: string;
  count: number;
  median: number;
  p99: number; // of a figure with a lower limit: 99 % of the samples are not below it
  wanted: Figure['wanted'];
  isMet: boolean | null; // null: without a limit
  conditions: string;
}

export function summarise({ name, unit, wanted, conditions, samples }: Figure): Summary {
  if (samples.length === 0 || !samples.every(Number.isFinite)) {
    throw new Error(`${name}: found ${samples.length} samples, expected finite ones`);
  }
  const least = wanted.least === true;
  const median = quantile(samples, 0.5);
  const p99 = least ? -quantile(samples.map((value) => -value), 0.99) : quantile(samples, 0.99);
  const holds = (value: number, limit: number | undefined) =>
    limit === undefined || (least ? value >= limit : value <= limit);
  const hasLimit = wanted.median !== undefined || wanted.p99 !== undefined;
  const isMet = hasLimit ? holds(median, wanted.median) && holds(p99, wanted.p99) : null;
  return { name, unit, count: samples.length, median, p99, wanted, isMet, conditions };
}

function limitText({ wanted, unit }: Summary): string {
  const sign = wanted.least === true ? '≥' : '≤';
  const parts = [
    wanted.median === undefined ? '' : `median ${sign} ${wanted.median}`,
    wanted.p99 === undefined ? '' : `p99 ${sign} ${wanted.p99}`,
  ];
  const text = parts.filter((part) => part !== '').join(', ');
  return text === '' ? 'no limit' : `${text} ${unit}`;
}

const shown = (value: number) => String(Number(value.toPrecision(3)));

export function summaryText(summary: Summary): string {
  const { name, unit, count, median, p99, isMet, conditions } = summary;
  const values = count === 1 ? shown(median) : `median ${shown(median)}, p99 ${shown(p99)}`;
  const verdict = isMet === null ? '' : isMet ? ': met' : ': MISSED';
  const samples = count === 1 ? '' : `; ${count} samples`;
  return `${name}: ${values} ${unit}\n    ${limitText(summary)}${verdict}${samples}; ${conditions}`;
}
