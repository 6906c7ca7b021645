// What the two charts of a search show: each evaluation over its number, with the best so far; and a dimension against the score.
import type { Ranking } from './ranking.js';
import type { RowStore } from './row_store.js';
import { drawnRows, padded, scoreRange } from './score_points.js';

export interface ChartContent {
  rows: readonly number[]; // evaluations that have a point
  x: Float64Array; // of each
  y: Float64Array; // NaN: it has no score, and its point is at the edge
  xRange: [number, number];
  yRange: [number, number];
  line: readonly { x: number; y: number }[]; // corners of the best so far
  level: number | null; // score of the scenario's own values
  best: number | null; // evaluation
  chosen: number | null; // evaluation
}

interface Shown {
  store: RowStore;
  ranking: Ranking;
  chosen: number | null;
  hasBaseline: boolean;
}

function content({ store, ranking, chosen, hasBaseline }: Shown, xOf: (row: number) => number): Omit<ChartContent, 'xRange' | 'line'> {
  const { objective, maximise } = ranking;
  const rows = drawnRows(ranking, store, chosen);
  const y = Float64Array.from(rows, (row) => (store.hasScore(row, objective) ? store.scoreOf(row, objective) : NaN));
  const isKnown = chosen !== null && chosen < store.count;
  return {
    rows,
    x: Float64Array.from(rows, xOf),
    y,
    yRange: scoreRange([...y].filter((score) => !Number.isNaN(score)), maximise),
    level: hasBaseline && store.hasScore(0, objective) ? store.scoreOf(0, objective) : null,
    best: ranking.records.at(-1) ?? null,
    chosen: isKnown ? chosen : null,
  };
}

export function learningCurve(shown: Shown): ChartContent {
  const { store, ranking } = shown;
  const last = Math.max(1, store.count - 1);
  const line: { x: number; y: number }[] = [];
  for (const row of ranking.records) {
    const before = line.at(-1);
    if (before !== undefined) line.push({ x: row, y: before.y });
    line.push({ x: row, y: store.scoreOf(row, ranking.objective) });
  }
  const end = line.at(-1);
  if (end !== undefined) line.push({ x: last, y: end.y });
  return { ...content(shown, (row) => row), xRange: [0, last], line };
}

// lowest, highest: of the values that the dimension may have.
export function valueChart(shown: Shown, dimension: number, { lowest, highest }: { lowest: number; highest: number }): ChartContent {
  return { ...content(shown, (row) => shown.store.valueOf(row, dimension)), xRange: padded(lowest, highest), line: [], level: null };
}
