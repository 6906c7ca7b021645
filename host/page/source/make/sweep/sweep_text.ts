// Texts about sweeps.
import type { OpenedSweep, SweepEntry } from '../../wire/messages.js';
import { countText, durationText, shortNumber, withUnit } from '../search/search_text.js';
import { cellQuantities, placesOf, type Cells } from './sweep_cells.js';

const stateTexts: Record<SweepEntry['state'], string> = {
  running: 'running',
  stopping: 'stopping …',
  ended: 'ended',
  interrupted: 'interrupted',
  unreadable: 'cannot be read',
};

export function stateText({ state }: Pick<SweepEntry, 'state'>): string {
  return stateTexts[state];
}

export function runsText({ made, planned }: Pick<SweepEntry, 'made' | 'planned'>): string {
  return `${countText(made)} of ${countText(planned)}`;
}

export function progressText(entry: SweepEntry): string {
  if (entry.state === 'unreadable') return stateText(entry);
  const left = entry.left_s === null ? '' : `, ${durationText(entry.left_s)} left`;
  return `${stateText(entry)}, ${runsText(entry)} runs${left}`;
}

// "amplitude 30 deg, frequency 1 Hz".
export function cellName(opened: Pick<OpenedSweep, 'quantities'>, cell: number): string {
  const quantities = cellQuantities(opened);
  const places = placesOf(quantities, cell);
  return quantities.map(({ name, unit, values }, i) => `${name} ${values[places[i]!] ?? ''}${unit === '' ? '' : ` ${unit}`}`).join(', ') || 'all runs';
}

// What was measured there, in words.
export function cellText(cells: Cells, cell: number, unit: string): string {
  const [values, failed] = [cells.values[cell]!, cells.failed[cell]!];
  const failures = failed === 0 ? '' : `${failed} ${failed === 1 ? 'run' : 'runs'} failed or without a value`;
  if (values === 0) return failures === '' ? 'not simulated yet' : failures;
  const deviation = cells.deviation[cell]!;
  const spread = Number.isNaN(deviation) ? '' : `standard deviation ${shortNumber(deviation, 3)}, ${values} values`;
  const notes = [spread, failures].filter(Boolean).join(', ');
  return `${withUnit(cells.mean[cell]!, unit)}${notes === '' ? '' : ` (${notes})`}`;
}
