// Draws a chart of scores on a canvas, and says where its points are.
import type { ChartTheme } from '../../panels/chart_theme.js';
import type { ChartContent } from './chart_content.js';
import type { CanvasSize } from './keep_drawn.js';
import { shortNumber } from './search_text.js';
import { axisTicks } from './score_points.js';

const edge = { left: 58, right: 10, top: 8, bottom: 34 }; // CSS pixels
const pixelsPerTick = { x: 90, y: 32 };
const frontRadius = 3.5; // CSS pixels

// Where the points are drawn, in CSS pixels.
export interface DrawnPoints {
  rows: readonly number[];
  x: Float32Array;
  y: Float32Array;
}

export interface ChartLabels {
  x: string;
  y: string;
}

export function drawChart(context: CanvasRenderingContext2D, chart: ChartContent, labels: ChartLabels, { width, height, ratio }: CanvasSize, theme: ChartTheme, maximise: boolean): DrawnPoints {
  const [right, bottom] = [width - edge.right, height - edge.bottom];
  const [[xLow, xHigh], [yLow, yHigh]] = [chart.xRange, chart.yRange];
  // What is worse than the range, or has no score, is at the edge.
  const pixelX = (value: number) => edge.left + ((Math.max(xLow, Math.min(xHigh, value)) - xLow) / (xHigh - xLow)) * (right - edge.left);
  const pixelY = (value: number) => bottom - ((Math.max(yLow, Math.min(yHigh, Number.isNaN(value) ? (maximise ? yLow : yHigh) : value)) - yLow) / (yHigh - yLow)) * (bottom - edge.top);
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  drawAxes();
  const points: DrawnPoints = { rows: chart.rows, x: Float32Array.from(chart.x, pixelX), y: Float32Array.from(chart.y, pixelY) };
  drawPoints();
  drawLines();
  drawFront();
  mark(chart.best, theme.lines[2] ?? theme.text, 4);
  mark(chart.chosen, theme.highlight, 5);
  return points;

  function drawAxes(): void {
    context.lineWidth = 1;
    context.strokeStyle = theme.grid;
    context.fillStyle = theme.text;
    context.font = '11px system-ui, sans-serif';
    context.textAlign = 'center';
    context.textBaseline = 'top';
    context.beginPath();
    for (const value of axisTicks(xLow, xHigh, (right - edge.left) / pixelsPerTick.x)) {
      const x = Math.round(pixelX(value)) + 0.5;
      context.moveTo(x, edge.top);
      context.lineTo(x, bottom);
      context.fillText(shortNumber(value), x, bottom + 4);
    }
    context.fillText(labels.x, (edge.left + right) / 2, bottom + 18, right - edge.left);
    context.textAlign = 'right';
    context.textBaseline = 'middle';
    for (const value of axisTicks(yLow, yHigh, (bottom - edge.top) / pixelsPerTick.y)) {
      const y = Math.round(pixelY(value)) + 0.5;
      context.moveTo(edge.left, y);
      context.lineTo(right, y);
      context.fillText(shortNumber(value), edge.left - 5, y);
    }
    context.stroke();
    context.save();
    context.translate(9, (edge.top + bottom) / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = 'center';
    context.fillText(labels.y, 0, 0, height - 4);
    context.restore();
  }

  function drawPoints(): void {
    const size = chart.rows.length > 800 ? 2 : 3;
    context.globalAlpha = 0.55;
    for (const isFailed of [false, true]) {
      context.fillStyle = (isFailed ? theme.lines[7] : theme.lines[0]) ?? theme.text;
      for (let i = 0; i < points.x.length; i += 1) {
        if (Number.isNaN(chart.y[i]) === isFailed) context.fillRect(points.x[i]! - size / 2, points.y[i]! - size / 2, size, size);
      }
    }
    context.globalAlpha = 1;
  }

  function drawLines(): void {
    if (chart.level !== null) {
      const y = pixelY(chart.level);
      context.strokeStyle = theme.text;
      context.setLineDash([5, 4]);
      context.beginPath();
      context.moveTo(edge.left, y);
      context.lineTo(right, y);
      context.stroke();
      context.setLineDash([]);
    }
    context.strokeStyle = theme.lines[1] ?? theme.text;
    context.lineWidth = 2;
    context.beginPath();
    for (const { x, y } of chart.line) context.lineTo(pixelX(x), pixelY(y));
    context.stroke();
  }

  function drawFront(): void {
    const marked = new Set(chart.marked);
    context.fillStyle = theme.lines[1] ?? theme.text;
    context.beginPath();
    for (const [place, row] of chart.rows.entries()) {
      if (!marked.has(row)) continue;
      context.moveTo(points.x[place]! + frontRadius, points.y[place]!);
      context.arc(points.x[place]!, points.y[place]!, frontRadius, 0, 2 * Math.PI);
    }
    context.fill();
  }

  function mark(row: number | null, colour: string, radius: number): void {
    const place = row === null ? -1 : chart.rows.indexOf(row);
    if (place < 0) return;
    context.strokeStyle = colour;
    context.lineWidth = 2;
    context.beginPath();
    context.arc(points.x[place]!, points.y[place]!, radius, 0, 2 * Math.PI);
    context.stroke();
  }
}
