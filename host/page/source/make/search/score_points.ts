// What a chart of scores draws: of many evaluations some, and the part of the axis that says most.
import type { Ranking } from './ranking.js';
import type { RowStore } from './row_store.js';

export const mostPoints = 3000;
const fewForQuantiles = 20;
const outlier = 4; // times as far from the best as nine of ten others

// From one drawn row to the next: a power of 2, so that the same rows are drawn while others come.
export function thinningStep(rows: number, most = mostPoints): number {
  let step = 1;
  while (Math.ceil(rows / step) > most) step *= 2;
  return step;
}

// The rows to draw, ascending: each `thinningStep`th, and those that must not be missing: the best, the records, the chosen one,
// and more.
export function drawnRows(ranking: Ranking, store: RowStore, chosen: number | null, more: readonly number[] = []): number[] {
  const step = thinningStep(store.count);
  const rows = Array.from({ length: Math.ceil(store.count / step) }, (_, i) => i * step);
  if (step === 1) return rows;
  const must = [...ranking.best, ...ranking.records, ...more, ...(chosen === null || chosen >= store.count ? [] : [chosen])];
  return [...new Set([...rows, ...must])].sort((a, b) => a - b);
}

// The range of the axis of scores: that of all, or without a few that are so bad that all others would be one line.
// scores: any order, all are numbers.
export function scoreRange(scores: readonly number[], maximise: boolean): [number, number] {
  if (scores.length === 0) return [0, 1];
  const sorted = Float64Array.from(scores).sort();
  const [least, most] = [sorted[0]!, sorted.at(-1)!];
  const [best, worst] = maximise ? [most, least] : [least, most];
  const worse = Math.floor((sorted.length - 1) / 10);
  const usual = sorted[maximise ? worse : sorted.length - 1 - worse]!;
  const end = sorted.length >= fewForQuantiles && usual !== best && Math.abs(worst - best) > outlier * Math.abs(usual - best) ? usual + (usual - best) : worst;
  return padded(Math.min(best, end), Math.max(best, end));
}

// With some room at both ends; a single value is in the middle.
export function padded(low: number, high: number): [number, number] {
  const room = high > low ? (high - low) * 0.05 : Math.max(Math.abs(low) * 0.1, 0.5);
  return [low - room, high + room];
}

// Round numbers in a range, about `count` of them.
export function axisTicks(low: number, high: number, count: number): number[] {
  const size = (high - low) / Math.max(1, count);
  if (!(size > 0) || !Number.isFinite(size)) return [];
  const power = 10 ** Math.floor(Math.log10(size));
  const step = power * ([1, 2, 5].find((factor) => factor * power >= size) ?? 10);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: Math.max(0, last - first + 1) }, (_, i) => Number(((first + i) * step).toPrecision(12)));
}

// The point that is nearest to a place on the screen, within `reach`; null: none. All are pixels.
export function nearestPoint(x: Float32Array, y: Float32Array, at: { x: number; y: number }, reach: number): number | null {
  let nearest: number | null = null;
  let least = reach * reach;
  for (let i = 0; i < x.length; i += 1) {
    const distance = (x[i]! - at.x) ** 2 + (y[i]! - at.y) ** 2;
    if (distance <= least) {
      least = distance;
      nearest = i;
    }
  }
  return nearest;
}
