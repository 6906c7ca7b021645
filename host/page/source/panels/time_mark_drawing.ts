// Markers and loop, drawn over a chart whose x axis is time.
import type { TimeMarks } from '../state/time_marks.js';
import type { TickRange } from '../state/time_view.js';
import { isDark } from '../view/theme.js';
import { chartTheme } from './chart_theme.js';

// The place of the chart on its canvas.
export interface ChartBox {
  left: number;
  width: number;
  height: number;
}

// A text that differs if the picture differs.
export function timeMarksKey(marks: TimeMarks | null): string {
  if (marks === null) return '';
  const { from, to } = marks.loop.peek();
  return [...marks.markers.peek().map(({ tick, name }) => `${tick} ${name}`), from, to].join();
}

export function drawTimeMarks(context: CanvasRenderingContext2D, marks: TimeMarks | null, box: ChartBox, range: TickRange): void {
  if (marks === null) return;
  const theme = chartTheme(isDark.peek());
  const xOf = (tick: number) => box.left + ((tick - range.from) / (range.to - range.from)) * box.width;
  const isVisible = (tick: number) => tick >= range.from && tick <= range.to;
  const drawLine = (tick: number) => context.fillRect(xOf(tick) - 0.75, 0, 1.5, box.height);
  context.save();
  context.fillStyle = theme.text;
  const { from, to } = marks.loop.peek();
  const left = xOf(Math.max(from ?? range.from, range.from));
  const right = xOf(Math.min(to ?? range.to, range.to));
  if ((from !== null || to !== null) && right > left) {
    context.globalAlpha = 0.15;
    context.fillRect(left, 0, right - left, box.height);
    context.globalAlpha = 1;
    for (const end of [from, to]) if (end !== null && isVisible(end)) drawLine(end);
  }
  context.font = '600 11px system-ui, sans-serif';
  context.textAlign = 'left';
  context.textBaseline = 'top';
  for (const { tick, name } of marks.markers.peek()) {
    if (isVisible(tick)) {
      const width = context.measureText(name).width + 8;
      const start = Math.min(xOf(tick), box.left + box.width - width);
      context.fillStyle = theme.highlight;
      drawLine(tick);
      context.fillRect(start, 0, width, 15);
      context.fillStyle = isDark.peek() ? '#161b22' : '#ffffff';
      context.fillText(name, start + 4, 2);
    }
  }
  context.restore();
}
