// Colours of strip and plots, which draw on canvases and so cannot use CSS.
import { divergingScale, type ColourScale } from '../data/strip_image.js';

export interface ChartTheme {
  text: string;
  grid: string;
  highlight: string;
  lines: readonly string[];
  strip: ColourScale;
  low: string;
  middle: string;
  high: string;
}

const hex = (colour: number) => `#${colour.toString(16).padStart(6, '0')}`;

function theme(text: string, grid: string, highlight: string, lines: string[], colours: [number, number, number]): ChartTheme {
  const [low, middle, high] = colours;
  return { text, grid, highlight, lines, strip: divergingScale(low, middle, high), low: hex(low), middle: hex(middle), high: hex(high) };
}

// Eight hues that differ in lightness too, after Okabe and Ito.
const light = theme(
  '#46505c',
  '#dfe4ea',
  '#b36b00',
  ['#0072b2', '#d55e00', '#00875f', '#b0489b', '#8a6d00', '#3f9fd6', '#5b5f66', '#c02942'],
  [0x1f5fa8, 0xf4f5f7, 0xd9660a],
);
const dark = theme(
  '#a9b4c0',
  '#2b323b',
  '#ffb833',
  ['#5ab4f0', '#ff8c42', '#2fcf9f', '#e58bd3', '#e6c229', '#9ad2ff', '#c3c9d1', '#ff7085'],
  [0x5aa9ff, 0x20262e, 0xff9d42],
);

export function chartTheme(isDark: boolean): ChartTheme {
  return isDark ? dark : light;
}

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

// Width of the axis at the left of strip and plots, in CSS pixels. It is the same for all, so that their times are aligned.
export const axisWidth = 64;

// Width of the margin at the right of the plots, for half of the last time; the style gives the strip the same margin.
export const axisOverhang = 12;
