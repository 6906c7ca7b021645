// Draws a map of gaits over its first two axes, with the trials of an adaptation on it, and says which cell is where.
import { colourOf, type ChartTheme } from '../../panels/chart_theme.js';
import type { MapAxis } from '../../wire/messages.js';
import type { GaitMap } from './gait_map.js';
import type { CanvasSize } from './keep_drawn.js';
import { axisTicks } from './score_points.js';
import { shortNumber } from './search_text.js';

const edge = { left: 62, right: 12, top: 10, bottom: 36 }; // CSS pixels
const pixelsPerTick = { x: 90, y: 36 };
const smallest = 2; // CSS pixels: half of a cell
const reach = 8; // CSS pixels beside a cell that is drawn small

export interface DrawnTrial {
  number: number; // from 1
  cell: number;
  isBest: boolean;
}

export interface MapPicture {
  map: GaitMap;
  trials: readonly DrawnTrial[];
  chosen: number | null; // cells
  pointed: number | null;
}

type Size = Pick<CanvasSize, 'width' | 'height'>;

// The lowest and the highest score of the filled cells; null: there is none.
export function scoreRange(map: GaitMap): [number, number] | null {
  let [low, high] = [Infinity, -Infinity];
  for (const cell of map.elites.keys()) {
    low = Math.min(low, map.scoreOf(cell));
    high = Math.max(high, map.scoreOf(cell));
  }
  return low <= high ? [low, high] : null;
}

function areaOf({ width, height }: Size) {
  return { left: edge.left, right: width - edge.right, top: edge.top, bottom: height - edge.bottom };
}

// Half the width and height of a cell, in CSS pixels.
function halfOf({ axes, centroids }: GaitMap, size: Size): { x: number; y: number } {
  const { left, right, top, bottom } = areaOf(size);
  if (centroids === null) return { x: (right - left) / axes[0]!.cells / 2, y: (bottom - top) / axes[1]!.cells / 2 };
  const share = 0.42 / Math.sqrt(centroids.length);
  return { x: Math.max(smallest, share * (right - left)), y: Math.max(smallest, share * (bottom - top)) };
}

function pixelOf(map: GaitMap, cell: number, size: Size): { x: number; y: number } {
  const { left, right, top, bottom } = areaOf(size);
  const { x, y } = map.placeOf(cell);
  return { x: left + x * (right - left), y: bottom - y * (bottom - top) };
}

// The worst first: of those that are drawn at the same place the best is in front.
function drawnCells(map: GaitMap, maximise: boolean): number[] {
  const sign = maximise ? 1 : -1;
  return [...map.elites.keys()].sort((a, b) => sign * (map.scoreOf(a) - map.scoreOf(b)));
}

// The filled cell at a place of the canvas; null: there is none.
export function filledCellAt(map: GaitMap, maximise: boolean, size: Size, at: { x: number; y: number }): number | null {
  const half = halfOf(map, size);
  const extra = { x: half.x < reach / 2 ? reach - half.x : 0, y: half.y < reach / 2 ? reach - half.y : 0 };
  const sign = maximise ? 1 : -1;
  let [found, least] = [null as number | null, Infinity];
  for (const cell of map.elites.keys()) {
    const pixel = pixelOf(map, cell, size);
    const [dx, dy] = [Math.abs(at.x - pixel.x), Math.abs(at.y - pixel.y)];
    if (dx > half.x + extra.x || dy > half.y + extra.y) continue;
    const distance = Math.hypot(dx, dy);
    const isInFront = distance === least && sign * (map.scoreOf(cell) - map.scoreOf(found!)) > 0;
    if (distance < least || isInFront) [found, least] = [cell, distance];
  }
  return found;
}

// The nearest filled cell in a direction, for the arrow keys; the cell itself if there is none.
export function nextFilledCell(map: GaitMap, from: number, [right, up]: readonly [number, number]): number {
  const start = map.placeOf(from);
  let [found, least] = [from, Infinity];
  for (const cell of map.elites.keys()) {
    const place = map.placeOf(cell);
    const [dx, dy] = [place.x - start.x, place.y - start.y];
    const along = dx * right + dy * up;
    const beside = Math.abs(dx * up) + Math.abs(dy * right);
    if (along > 1e-9 && along + 2 * beside < least) [found, least] = [cell, along + 2 * beside];
  }
  return found;
}

function title({ name, unit }: MapAxis): string {
  return unit === '' ? name : `${name} (${unit})`;
}

export function drawMap(context: CanvasRenderingContext2D, { map, trials, chosen, pointed }: MapPicture, maximise: boolean, size: CanvasSize, theme: ChartTheme): void {
  const area = areaOf(size);
  const half = halfOf(map, size);
  const range = scoreRange(map);
  context.setTransform(size.ratio, 0, 0, size.ratio, 0, 0);
  context.clearRect(0, 0, size.width, size.height);
  context.font = '11px system-ui, sans-serif';
  drawAxes();
  const outline = (cell: number, grow: number) => {
    const { x, y } = pixelOf(map, cell, size);
    context.beginPath();
    // Half a pixel more, so that no light line is between two cells of a grid.
    if (map.centroids === null) context.rect(x - half.x - grow, y - half.y - grow, 2 * (half.x + grow) + (grow === 0 ? 0.5 : 0), 2 * (half.y + grow) + (grow === 0 ? 0.5 : 0));
    else context.ellipse(x, y, half.x + grow, half.y + grow, 0, 0, 2 * Math.PI);
  };
  for (const cell of drawnCells(map, maximise)) {
    if (range === null) break;
    context.fillStyle = colourOf(map.scoreOf(cell), range, theme);
    outline(cell, 0);
    context.fill();
  }
  for (const [cell, colour, line] of [[chosen, theme.highlight, 3], [pointed, theme.text, 1.5]] as const) {
    if (cell === null) continue;
    context.strokeStyle = colour;
    context.lineWidth = line;
    outline(cell, Math.max(1, 4 - Math.min(half.x, half.y)));
    context.stroke();
  }
  for (const trial of trials) drawTrial(trial);

  function drawAxes(): void {
    const [first, second] = map.axes;
    if (first === undefined || second === undefined) return;
    context.lineWidth = 1;
    context.strokeStyle = theme.grid;
    context.strokeRect(area.left, area.top, area.right - area.left, area.bottom - area.top);
    context.fillStyle = theme.text;
    context.textAlign = 'center';
    context.textBaseline = 'top';
    const shareOf = (value: number, { lowest, highest }: MapAxis) => (value - lowest) / (highest - lowest);
    for (const value of axisTicks(first.lowest, first.highest, (area.right - area.left) / pixelsPerTick.x)) {
      context.fillText(shortNumber(value), area.left + shareOf(value, first) * (area.right - area.left), area.bottom + 5);
    }
    context.fillText(title(first), (area.left + area.right) / 2, area.bottom + 20, area.right - area.left);
    context.textAlign = 'right';
    context.textBaseline = 'middle';
    for (const value of axisTicks(second.lowest, second.highest, (area.bottom - area.top) / pixelsPerTick.y)) {
      context.fillText(shortNumber(value), area.left - 5, area.bottom - shareOf(value, second) * (area.bottom - area.top));
    }
    context.save();
    context.translate(9, (area.top + area.bottom) / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = 'center';
    context.fillText(title(second), 0, 0, size.height - 4);
    context.restore();
  }

  function drawTrial({ number, cell, isBest }: DrawnTrial): void {
    const { x, y } = pixelOf(map, cell, size);
    context.beginPath();
    context.arc(x, y, 8, 0, 2 * Math.PI);
    context.fillStyle = theme.middle;
    context.fill();
    context.strokeStyle = isBest ? theme.highlight : theme.text;
    context.lineWidth = isBest ? 3 : 1;
    context.stroke();
    context.fillStyle = theme.text;
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    context.fillText(String(number), x, y + 0.5, 13);
  }
}
