// What the charts of a search show: each evaluation over its number, with the best so far; a dimension against the score; and two
// scores against each other, with the Pareto front. They differ in this alone: they are drawn, and chosen from, in the same way.
import type { Front } from './front.js';
import type { Ranking } from './ranking.js';
import type { RowStore } from './row_store.js';
import { drawnRows, padded, scoreRange } from './score_points.js';

export interface ChartContent {
  rows: readonly number[]; // evaluations that have a point
  x: Float64Array; // of each
  y: Float64Array; // NaN: it has no score, and its point is at the edge
  xRange: [number, number];
  yRange: [number, number];
  line: readonly { x: number; y: number }[]; // corners of the best so far, or of the front
  marked: readonly number[]; // evaluations on the front
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

function content({ store, ranking, chosen, hasBaseline }: Shown, xOf: (row: number) => number): Omit<ChartContent, 'xRange' | 'line' | 'marked'> {
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
  return { ...content(shown, (row) => row), xRange: [0, last], line, marked: [] };
}

// lowest, highest: of the values that the dimension may have.
export function valueChart(shown: Shown, dimension: number, { lowest, highest }: { lowest: number; highest: number }): ChartContent {
  return { ...content(shown, (row) => shown.store.valueOf(row, dimension)), xRange: padded(lowest, highest), line: [], marked: [], level: null };
}

const ends = (values: readonly number[]): [number, number] => [Math.min(...values), Math.max(...values)];

// The first score to the right, the second one upwards. What failed has no place there.
export function frontChart({ store, ranking, chosen }: Shown, front: Front, [first, second]: readonly [boolean, boolean]): ChartContent {
  const rows = drawnRows(ranking, store, chosen, front.rows).filter((row) => front.hasScores(row));
  const [x, y] = [0, 1].map((objective) => Float64Array.from(rows, (row) => store.scoreOf(row, objective))) as [Float64Array, Float64Array];
  const rangeOf = (scores: Float64Array, objective: number, maximise: boolean): [number, number] => {
    const [low, high] = scoreRange([...scores], maximise);
    const [lowest, highest] = padded(...ends(front.rows.map((row) => store.scoreOf(row, objective))));
    return front.rows.length === 0 ? [low, high] : [Math.min(low, lowest), Math.max(high, highest)];
  };
  const [xRange, yRange] = [rangeOf(x, 0, first), rangeOf(y, 1, second)];
  // The border of what the front dominates: from point to point through the corner that is worse in both scores.
  const corners = front.rows.map((row) => ({ x: store.scoreOf(row, 0), y: store.scoreOf(row, 1) }));
  if (!first) corners.reverse();
  const [worstX, worstY] = [first ? xRange[0] : xRange[1], second ? yRange[0] : yRange[1]];
  const line = corners.flatMap(({ x: cornerX, y: cornerY }, i) => [{ x: corners[i - 1]?.x ?? worstX, y: cornerY }, { x: cornerX, y: cornerY }]);
  const end = corners.at(-1);
  if (end !== undefined) line.push({ x: end.x, y: worstY });
  return { rows, x, y, xRange, yRange, line, marked: front.rows, level: null, best: null, chosen: rows.includes(chosen ?? -1) ? chosen : null };
}
