// A chart of scores on a canvas. It is drawn again only when what it shows has changed, and a click chooses the nearest point.
import { effect } from '@preact/signals-core';
import { useEffect, useRef } from 'preact/hooks';
import { chartTheme } from '../../panels/chart_theme.js';
import { isDark } from '../../view/theme.js';
import type { ChartContent } from './chart_content.js';
import { drawChart, type ChartLabels, type DrawnPoints } from './chart_drawing.js';
import { nearestPoint } from './score_points.js';

const height = 170; // CSS pixels
const reach = 14;

export interface Chart {
  id: string; // another chart has another one
  title: string; // for screen readers
  labels: ChartLabels;
  maximise: boolean;
  follow(): void; // reads the signals after whose changes it is drawn again
  content(): ChartContent;
  choose(row: number): void;
}

// Draws with the next frame, once for several changes. Returns the function that ends it.
function keepDrawn(canvas: HTMLCanvasElement, chart: Chart, drawn: (points: DrawnPoints) => void): () => void {
  let width = canvas.clientWidth;
  let frame = 0;
  const draw = () => {
    frame = 0;
    if (width < 100) return;
    const ratio = window.devicePixelRatio;
    // A new size makes the canvas anew, which is expensive.
    const size = { width: Math.round(width * ratio), height: Math.round(height * ratio) };
    if (canvas.width !== size.width || canvas.height !== size.height) Object.assign(canvas, size);
    const context = canvas.getContext('2d') as CanvasRenderingContext2D;
    drawn(drawChart(context, chart.content(), chart.labels, { width, height, ratio }, chartTheme(isDark.peek()), chart.maximise));
  };
  const drawSoon = () => {
    if (frame === 0) frame = requestAnimationFrame(draw);
  };
  const observer = new ResizeObserver(([entry]) => {
    width = (entry as ResizeObserverEntry).contentRect.width;
    drawSoon();
  });
  observer.observe(canvas);
  const stop = effect(() => {
    isDark.value;
    chart.follow();
    drawSoon();
  });
  return () => {
    stop();
    observer.disconnect();
    cancelAnimationFrame(frame);
  };
}

export function ScoreChart({ chart, testId }: { chart: Chart; testId: string }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const points = useRef<DrawnPoints | null>(null);
  useEffect(() => keepDrawn(canvas.current as HTMLCanvasElement, chart, (drawn) => (points.current = drawn)), [chart.id]);
  const rowAt = (event: MouseEvent): number | null => {
    const drawn = points.current;
    const box = (event.currentTarget as HTMLCanvasElement).getBoundingClientRect();
    const place = drawn === null ? null : nearestPoint(drawn.x, drawn.y, { x: event.clientX - box.left, y: event.clientY - box.top }, reach);
    return place === null ? null : (drawn?.rows[place] ?? null);
  };
  return (
    <canvas
      ref={canvas}
      class="score-chart"
      role="img"
      aria-label={chart.title}
      data-testid={testId}
      onPointerMove={(event) => {
        const row = rowAt(event);
        event.currentTarget.title = row === null ? '' : `candidate ${row}`;
        event.currentTarget.classList.toggle('on-point', row !== null);
      }}
      onClick={(event) => {
        const row = rowAt(event);
        if (row !== null) chart.choose(row);
      }}
    />
  );
}
