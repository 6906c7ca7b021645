// A chart of scores on a canvas. It is drawn again only when what it shows has changed, and a click chooses the nearest point.
import { useEffect, useRef } from 'preact/hooks';
import type { ChartContent } from './chart_content.js';
import { drawChart, type ChartLabels, type DrawnPoints } from './chart_drawing.js';
import { keepDrawn } from './keep_drawn.js';
import { nearestPoint } from './score_points.js';

const reach = 14; // CSS pixels

export interface Chart {
  id: string; // another chart has another one
  title: string; // for screen readers
  labels: ChartLabels;
  maximise: boolean; // whether what has no score is at the lower end
  follow(): void; // reads the signals after whose changes it is drawn again
  content(): ChartContent;
  choose(row: number): void;
}

export function ScoreChart({ chart, testId }: { chart: Chart; testId: string }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const points = useRef<DrawnPoints | null>(null);
  useEffect(() => {
    const draw: Parameters<typeof keepDrawn>[2] = (context, size, theme) => (points.current = drawChart(context, chart.content(), chart.labels, size, theme, chart.maximise));
    return keepDrawn(canvas.current as HTMLCanvasElement, () => chart.follow(), draw);
  }, [chart.id]);
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
