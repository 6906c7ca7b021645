// Draws what a sweep has measured: over one quantity a line of means with their standard deviations, over two a map.
import { colourOf, type ChartTheme } from '../../panels/chart_theme.js';
import type { SweptQuantity } from '../../wire/messages.js';
import type { CanvasSize } from '../search/keep_drawn.js';
import { axisTicks, padded } from '../search/score_points.js';
import { shortNumber } from '../search/search_text.js';
import { meanRange, type Cells } from './sweep_cells.js';

const edge = { left: 62, right: 12, top: 10, bottom: 36 }; // CSS pixels
const pixelsPerLabel = { x: 56, y: 20 };
const smallestForMarks = 8; // CSS pixels of a cell

export interface Picture {
  cells: Cells;
  axes: readonly SweptQuantity[]; // one or two, the first to the right
  measure: string; // with its unit
  best: number | null; // cells
  chosen: number | null;
  pointed: number | null;
}

interface Area {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

function areaOf({ width, height }: Pick<CanvasSize, 'width' | 'height'>): Area {
  return { left: edge.left, right: width - edge.right, top: edge.top, bottom: height - edge.bottom };
}

// The cell at a place of the canvas; null: there is none.
export function cellAt(axes: readonly SweptQuantity[], size: Pick<CanvasSize, 'width' | 'height'>, at: { x: number; y: number }): number | null {
  const { left, right, top, bottom } = areaOf(size);
  if (at.x < left || at.x >= right || at.y < top || at.y >= bottom) return null;
  const [first, second] = axes.map(({ values }) => values.length);
  if (first === undefined) return null;
  if (second === undefined) return nearestOnLine(axes[0]!, (at.x - left) / (right - left));
  const column = Math.floor(((at.x - left) / (right - left)) * first);
  const row = Math.floor(((bottom - at.y) / (bottom - top)) * second);
  return column * second + row;
}

function lineRange({ values }: SweptQuantity): [number, number] {
  return padded(Number(values[0]), Number(values.at(-1)));
}

// share: of the width.
function nearestOnLine(axis: SweptQuantity, share: number): number {
  const [low, high] = lineRange(axis);
  const [first, last] = [Number(axis.values[0]), Number(axis.values.at(-1))];
  // The values have equal distances.
  const place = ((low + share * (high - low) - first) / (last - first)) * (axis.values.length - 1);
  return Math.max(0, Math.min(axis.values.length - 1, Math.round(place)));
}

function title({ name, unit }: SweptQuantity): string {
  return unit === '' ? name : `${name} (${unit})`;
}

export function drawPicture(context: CanvasRenderingContext2D, picture: Picture, size: CanvasSize, theme: ChartTheme): void {
  const area = areaOf(size);
  context.setTransform(size.ratio, 0, 0, size.ratio, 0, 0);
  context.clearRect(0, 0, size.width, size.height);
  context.font = '11px system-ui, sans-serif';
  context.lineWidth = 1;
  const [first, second] = picture.axes;
  if (first === undefined) return;
  if (second === undefined) drawLine(context, picture, first, area, theme);
  else drawMap(context, picture, [first, second], area, theme);
  context.fillStyle = theme.text;
  context.textAlign = 'center';
  context.textBaseline = 'top';
  context.fillText(title(first), (area.left + area.right) / 2, area.bottom + 20, area.right - area.left);
  context.save();
  context.translate(10, (area.top + area.bottom) / 2);
  context.rotate(-Math.PI / 2);
  context.textBaseline = 'middle';
  context.fillText(second === undefined ? picture.measure : title(second), 0, 0, size.height - 4);
  context.restore();
}

function drawMap(context: CanvasRenderingContext2D, { cells, best, chosen, pointed }: Picture, [x, y]: readonly [SweptQuantity, SweptQuantity], area: Area, theme: ChartTheme): void {
  const [columns, rows] = [x.values.length, y.values.length];
  const [width, height] = [(area.right - area.left) / columns, (area.bottom - area.top) / rows];
  const range = meanRange(cells);
  const corner = (cell: number) => ({ left: area.left + Math.floor(cell / rows) * width, top: area.bottom - ((cell % rows) + 1) * height });
  const hasMarks = Math.min(width, height) >= smallestForMarks;
  for (let cell = 0; cell < columns * rows; cell += 1) {
    const { left, top } = corner(cell);
    const mean = cells.mean[cell]!;
    if (!Number.isNaN(mean) && range !== null) {
      context.fillStyle = colourOf(mean, range, theme);
      // Half a pixel more, so that no light line is between two cells.
      context.fillRect(left, top, width + 0.5, height + 0.5);
    }
    if (cells.failed[cell]! > 0) drawFailure(context, left, top, width, height, { isWhole: Number.isNaN(mean), hasMarks, theme });
  }
  context.strokeStyle = theme.grid;
  context.strokeRect(area.left, area.top, area.right - area.left, area.bottom - area.top);
  context.fillStyle = theme.text;
  context.textAlign = 'center';
  context.textBaseline = 'top';
  eachLabel(columns, width, pixelsPerLabel.x, (place) => context.fillText(x.values[place]!, area.left + (place + 0.5) * width, area.bottom + 5));
  context.textAlign = 'right';
  context.textBaseline = 'middle';
  eachLabel(rows, height, pixelsPerLabel.y, (place) => context.fillText(y.values[place]!, area.left - 5, area.bottom - (place + 0.5) * height));
  for (const [cell, colour, line] of [[best, theme.text, 2], [chosen, theme.highlight, 3], [pointed, theme.text, 1]] as const) {
    if (cell === null || cell >= columns * rows) continue;
    const { left, top } = corner(cell);
    const grow = Math.max(0, (6 - Math.min(width, height)) / 2); // a cell of a large map is small
    context.strokeStyle = colour;
    context.lineWidth = line;
    context.strokeRect(left - grow + 0.5, top - grow + 0.5, width + 2 * grow - 1, height + 2 * grow - 1);
  }
}

// A cross where no run has a value, a dot where some have none.
function drawFailure(context: CanvasRenderingContext2D, left: number, top: number, width: number, height: number, { isWhole, hasMarks, theme }: { isWhole: boolean; hasMarks: boolean; theme: ChartTheme }): void {
  const colour = theme.lines[7] ?? theme.text;
  const [x, y] = [left + width / 2, top + height / 2];
  const reach = Math.max(0.5, Math.min(5, width / 2 - 1, height / 2 - 1));
  context.strokeStyle = colour;
  context.fillStyle = colour;
  context.lineWidth = 1.5;
  if (!isWhole) {
    if (hasMarks) context.fillRect(left + width - 4, top + 1, 3, 3);
    return;
  }
  context.beginPath();
  context.moveTo(x - reach, y - reach);
  context.lineTo(x + reach, y + reach);
  context.moveTo(x + reach, y - reach);
  context.lineTo(x - reach, y + reach);
  context.stroke();
}

function eachLabel(count: number, size: number, room: number, draw: (place: number) => void): void {
  const step = Math.max(1, Math.ceil(room / size));
  for (let place = 0; place < count; place += step) draw(place);
}

function drawLine(context: CanvasRenderingContext2D, { cells, best, chosen, pointed }: Picture, axis: SweptQuantity, area: Area, theme: ChartTheme): void {
  const spread = (cell: number) => (Number.isNaN(cells.deviation[cell]!) ? 0 : cells.deviation[cell]!);
  const known = axis.values.map((_, cell) => cell).filter((cell) => !Number.isNaN(cells.mean[cell]!));
  const heights = known.flatMap((cell) => [cells.mean[cell]! - spread(cell), cells.mean[cell]! + spread(cell)]);
  const [low, high] = heights.length === 0 ? [0, 1] : padded(heights.reduce((a, b) => Math.min(a, b)), heights.reduce((a, b) => Math.max(a, b)));
  const [xLow, xHigh] = lineRange(axis);
  const pixelX = (value: number) => area.left + ((value - xLow) / (xHigh - xLow)) * (area.right - area.left);
  const pixelY = (value: number) => area.bottom - ((value - low) / (high - low)) * (area.bottom - area.top);
  const at = (cell: number) => ({ x: pixelX(Number(axis.values[cell])), y: pixelY(cells.mean[cell]!) });
  context.strokeStyle = theme.grid;
  context.fillStyle = theme.text;
  context.textAlign = 'center';
  context.textBaseline = 'top';
  context.beginPath();
  for (const value of axisTicks(xLow, xHigh, (area.right - area.left) / 90)) {
    context.moveTo(Math.round(pixelX(value)) + 0.5, area.top);
    context.lineTo(Math.round(pixelX(value)) + 0.5, area.bottom);
    context.fillText(shortNumber(value), pixelX(value), area.bottom + 5);
  }
  context.textAlign = 'right';
  context.textBaseline = 'middle';
  for (const value of axisTicks(low, high, (area.bottom - area.top) / 36)) {
    context.moveTo(area.left, Math.round(pixelY(value)) + 0.5);
    context.lineTo(area.right, Math.round(pixelY(value)) + 0.5);
    context.fillText(shortNumber(value), area.left - 5, pixelY(value));
  }
  context.stroke();
  const colour = theme.lines[0] ?? theme.text;
  context.strokeStyle = colour;
  context.fillStyle = colour;
  context.beginPath();
  for (const cell of known) {
    context.moveTo(at(cell).x, pixelY(cells.mean[cell]! - spread(cell)));
    context.lineTo(at(cell).x, pixelY(cells.mean[cell]! + spread(cell)));
  }
  context.stroke();
  context.lineWidth = 2;
  context.beginPath();
  // A gap where no run has a value.
  for (const [place, cell] of known.entries()) {
    if (known[place - 1] === cell - 1) context.lineTo(at(cell).x, at(cell).y);
    else context.moveTo(at(cell).x, at(cell).y);
  }
  context.stroke();
  if (known.length <= (area.right - area.left) / 4) {
    for (const cell of known) {
      context.beginPath();
      context.arc(at(cell).x, at(cell).y, 3, 0, 2 * Math.PI);
      context.fill();
    }
  }
  for (const cell of axis.values.keys()) {
    if (cells.failed[cell]! > 0) drawFailure(context, pixelX(Number(axis.values[cell])) - 6, area.bottom - 12, 12, 12, { isWhole: Number.isNaN(cells.mean[cell]!), hasMarks: true, theme });
  }
  for (const [cell, ring, radius] of [[best, theme.lines[2] ?? theme.text, 5], [chosen, theme.highlight, 7], [pointed, theme.text, 9]] as const) {
    if (cell === null || Number.isNaN(cells.mean[cell] ?? NaN)) continue;
    context.strokeStyle = ring;
    context.beginPath();
    context.arc(at(cell).x, at(cell).y, radius, 0, 2 * Math.PI);
    context.stroke();
  }
}
