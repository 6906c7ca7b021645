// The colours of values in maps: those of sweeps and of gaits.
import type { ChartTheme } from '../../panels/chart_theme.js';

// Where a value is on a scale from -1, dark blue, over 0, pale, to 1, dark orange: as in the picture of the sweep's folder,
// positive ones are blue, negative ones orange, and if both occur 0 is pale.
export function colourPlace(value: number, [low, high]: readonly [number, number]): number {
  const least = 0.12; // so that no value looks like none
  if (low < 0 && high > 0) return -value / Math.max(-low, high);
  const share = high > low ? (value - low) / (high - low) : 1;
  return low >= 0 ? -(least + (1 - least) * share) : least + (1 - least) * (1 - share);
}

export function colourOf(value: number, range: readonly [number, number], { strip }: Pick<ChartTheme, 'strip'>): string {
  const place = Math.max(-1, Math.min(1, colourPlace(value, range)));
  const colour = strip[Math.round(((place + 1) / 2) * (strip.length - 1))]!;
  return `rgb(${colour & 255} ${(colour >> 8) & 255} ${(colour >> 16) & 255})`;
}
