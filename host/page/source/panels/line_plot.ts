// A uPlot chart of lines, redrawn from the history when something changed.
import uPlot from 'uplot';
import { lineData } from '../data/line_data.js';
import { onFrame } from '../view/frame_clock.js';
import type { TelemetryHistory } from '../data/telemetry_history.js';
import type { RobotView } from '../view/robot_view.js';
import type { Line } from '../state/signal_selection.js';
import { axisOverhang, axisWidth, chartTheme } from './chart_theme.js';
import { drawTimeMarks, timeMarksKey } from './time_mark_drawing.js';

const height = 170; // CSS pixels
const framePeriod = 30; // milliseconds
const mostClickPixels = 3; // a drag goes farther

// The range of the axis, with some room above and below; a constant value is in the middle. `low`, `high`: null without values.
function padded(low: number | null, high: number | null): [number, number] {
  if (low === null || high === null) {
    return [-1, 1];
  }
  const room = high > low ? (high - low) * 0.06 : Math.max(Math.abs(low) * 0.1, 0.5);
  return [low - room, high + room];
}

export class LinePlot {
  private readonly plot: uPlot;
  private readonly compared; // a second recording, whose lines are dashed
  private readonly cursor = document.createElement('div');
  private readonly stops: (() => void)[] = [];
  private lastKey = '';
  private lastTime = 0;

  constructor(
    private readonly app: RobotView,
    holder: HTMLElement,
    private readonly lines: readonly Line[],
    isDark: boolean,
  ) {
    this.compared = app.compared?.peek()?.reader ?? null;
    const options = this.options(Math.max(100, holder.clientWidth), isDark);
    this.plot = new uPlot(options, options.series.map(() => []) as unknown as uPlot.AlignedData, holder);
    this.cursor.className = 'plot-cursor';
    this.plot.over.append(this.cursor);
    const observer = new ResizeObserver(() => this.plot.setSize({ width: Math.max(100, holder.clientWidth), height }));
    observer.observe(holder);
    this.stops.push(() => observer.disconnect(), onFrame((now) => this.draw(now)));
    this.listen();
  }

  dispose(): void {
    this.stops.forEach((stop) => stop());
    this.plot.destroy();
  }

  private options(width: number, isDark: boolean): uPlot.Options {
    const theme = chartTheme(isDark);
    const series = this.lines.map((_, i) => ({ stroke: theme.lines[i] ?? theme.text, width: 1.5, points: { show: false } }));
    const dashed = this.compared === null ? [] : series.map((line) => ({ ...line, dash: [5, 4], alpha: 0.8 }));
    const axis = { stroke: theme.text, grid: { stroke: theme.grid, width: 1 }, ticks: { stroke: theme.grid, width: 1 } };
    return {
      width,
      height,
      padding: [8, axisOverhang, 0, 0],
      legend: { show: false },
      cursor: { x: false, y: false, points: { show: false }, drag: { x: true, y: false, setScale: false } },
      scales: { x: { time: false, auto: false }, y: { auto: true, range: (_, low, high) => padded(low, high) } },
      axes: [
        { ...axis, size: 32, values: (_, ticks) => ticks.map((value) => `${Number(value.toFixed(3))} s`) },
        { ...axis, size: axisWidth, space: 24 },
      ],
      series: [{}, ...series, ...dashed],
      hooks: { setSelect: [(plot) => this.zoomToSelection(plot)], draw: [(plot) => this.drawMarks(plot)] },
    };
  }

  private drawMarks({ ctx, bbox }: uPlot): void {
    const { marks, time } = this.app;
    const ratio = window.devicePixelRatio;
    ctx.save();
    ctx.translate(0, bbox.top);
    ctx.scale(ratio, ratio);
    const box = { left: bbox.left / ratio, width: bbox.width / ratio, height: bbox.height / ratio };
    drawTimeMarks(ctx, marks, box, time.range(this.app.newestTick));
    ctx.restore();
  }

  private zoomToSelection(plot: uPlot): void {
    const { left, width } = plot.select;
    if (width > 3) {
      const rate = this.app.tickRate;
      this.app.time.detach({ from: plot.posToVal(left, 'x') * rate, to: plot.posToVal(left + width, 'x') * rate });
      plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    }
  }

  private listen(): void {
    const { over } = this.plot;
    const tickAt = (event: MouseEvent) => this.plot.posToVal(event.clientX - over.getBoundingClientRect().left, 'x') * this.app.tickRate;
    const { time } = this.app;
    let pressedAt = 0;
    const press = (event: MouseEvent) => (pressedAt = event.clientX);
    // A click sets the cursor, except at the end of a drag, which zooms.
    const click = (event: MouseEvent) => {
      if (Math.abs(event.clientX - pressedAt) <= mostClickPixels) time.pick(tickAt(event));
    };
    const wheel = (event: WheelEvent) => {
      event.preventDefault();
      time.zoom(Math.exp(event.deltaY * 0.002), tickAt(event), this.app.newestTick);
    };
    over.addEventListener('mousemove', (event) => time.hover(tickAt(event)));
    over.addEventListener('mouseleave', () => time.leave());
    over.addEventListener('mousedown', press);
    over.addEventListener('click', click);
    over.addEventListener('wheel', wheel, { passive: false });
  }

  private draw(now: number): void {
    const { history, time } = this.app;
    const range = time.range(this.app.newestTick);
    const cursor = time.cursor.peek();
    const other = this.compared?.history;
    const key = [history.run, history.end, other?.run, other?.end, range.from, range.to, cursor, this.plot.width, timeMarksKey(this.app.marks)].join();
    if (key === this.lastKey || now - this.lastTime < framePeriod) {
      return;
    }
    this.lastKey = key;
    this.lastTime = now;
    const rate = this.app.tickRate;
    const dataOf = (rows: TelemetryHistory): uPlot.AlignedData => {
      const data = lineData(rows, this.lines, range.from, range.to, this.plot.over.clientWidth);
      return [data.times.map((tick) => tick / rate), ...data.values];
    };
    const data = other === undefined ? dataOf(history) : uPlot.join([dataOf(history), dataOf(other)]);
    this.plot.batch(() => {
      this.plot.setData(data, false);
      this.plot.setScale('x', { min: range.from / rate, max: range.to / rate });
    });
    const isVisible = cursor !== null && cursor >= range.from && cursor <= range.to;
    this.cursor.hidden = !isVisible;
    if (isVisible) {
      this.cursor.style.transform = `translateX(${this.plot.valToPos(cursor / rate, 'x')}px)`;
    }
  }
}
