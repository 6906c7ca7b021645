// The trials of an adaptation in the map of gaits that they were chosen from.
import type { Adaptation, AdaptationTrial } from '../../wire/messages.js';
import type { GaitMap } from './gait_map.js';
import type { DrawnTrial } from './map_drawing.js';
import type { RowStore } from './row_store.js';

// The position of the best trial of those that have a score, of equal ones the first; null: there is none.
export function bestTrial({ trials }: Pick<Adaptation, 'trials'>, maximise: boolean): number | null {
  let best: number | null = null;
  for (const [place, { measured, failure }] of trials.entries()) {
    if (failure !== null) continue;
    const other = best === null ? NaN : trials[best]!.measured;
    if (best === null || (maximise ? measured > other : measured < other)) best = place;
  }
  return best;
}

// Of several trials of one cell the last one: they would be drawn over one another.
export function trialCells(adaptation: Pick<Adaptation, 'trials'>, map: GaitMap, maximise: boolean): DrawnTrial[] {
  const best = bestTrial(adaptation, maximise);
  const byCell = new Map<number, DrawnTrial>();
  for (const [place, trial] of adaptation.trials.entries()) {
    const cell = map.cellNamed(trial.cell);
    if (cell !== null) byCell.set(cell, { number: place + 1, cell, isBest: place === best || (byCell.get(cell)?.isBest ?? false) });
  }
  return [...byCell.values()];
}

// The first evaluation of the gait that was tried, which need not be the best of its cell; null if the store has none.
export function trialRow({ values }: Pick<AdaptationTrial, 'values'>, store: RowStore): number | null {
  if (values.length !== store.dimensions) return null;
  // The store has them with less precision; values of a search are farther apart.
  const isValueOf = (row: number) => (value: number, dimension: number) => Math.abs(value - store.valueOf(row, dimension)) <= 1e-5 * Math.max(1, Math.abs(value));
  for (let row = 0; row < store.count; row += 1) {
    if (values.every(isValueOf(row))) return row;
  }
  return null;
}
