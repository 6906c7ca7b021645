// The space-time strip: one signal of all joints over time.
import { useEffect, useRef } from 'preact/hooks';
import { fillStrip, largestMagnitude } from '../data/strip_image.js';
import { onFrame } from '../view/frame_clock.js';
import type { RobotView } from '../view/robot_view.js';
import { formatMeasured, roundStep } from '../state/parameter_values.js';
import { isDark } from '../view/theme.js';
import { axisWidth, chartTheme } from './chart_theme.js';
import { drawTimeMarks, timeMarksKey } from './time_mark_drawing.js';
import { signalTitle, valueName } from './value_names.js';

const framePeriod = 30; // milliseconds: about 30 images a second
const smallestLabel = 14; // CSS pixels between two names of joints
// Heights in CSS pixels: of the strip, and of a joint in it if there are many.
const smallestHeight = 120;
const largestHeight = 260;
const jointHeight = 4;

// One canvas for the image with a pixel for each value; the browser enlarges it.
class StripImage {
  private readonly canvas = document.createElement('canvas');
  private readonly context = this.canvas.getContext('2d') as CanvasRenderingContext2D;
  private image = this.context.createImageData(1, 1);

  resize(columns: number, rows: number): Uint32Array {
    if (this.image.width !== columns || this.image.height !== rows) {
      this.canvas.width = columns;
      this.canvas.height = rows;
      this.image = this.context.createImageData(columns, rows);
    }
    return new Uint32Array(this.image.data.buffer);
  }

  draw(target: CanvasRenderingContext2D, x: number, width: number, height: number): void {
    this.context.putImageData(this.image, 0, 0);
    target.imageSmoothingEnabled = false;
    target.drawImage(this.canvas, x, 0, width, height);
  }
}

class StripDrawing {
  private readonly image = new StripImage();
  private lastKey = '';
  private lastTime = 0;
  // The size in CSS pixels is kept, because reading it from the canvas in each frame makes the browser lay out the page
  // twice.
  private box = { width: 0, height: 0 };
  private readonly observer = new ResizeObserver(([entry]) => (this.box = (entry as ResizeObserverEntry).contentRect));

  constructor(
    private readonly app: RobotView,
    private readonly canvas: HTMLCanvasElement,
    private readonly legend: { current: HTMLElement | null },
  ) {
    this.observer.observe(canvas);
  }

  end(): void {
    this.observer.disconnect();
  }

  draw(now: number): void {
    const { app, canvas, box } = this;
    const { sampledRows: history, selection, time } = app;
    const newest = app.newestTick;
    const range = time.range(newest);
    const hovered = selection.hoveredJoint.peek();
    const name = selection.strip.peek();
    const marks = [time.cursor.peek(), hovered, name, isDark.peek(), timeMarksKey(app.marks)];
    const key = [history.run, history.end, range.from, range.to, ...marks, box.width, box.height].join();
    if (key === this.lastKey || now - this.lastTime < framePeriod || box.width < axisWidth + 10) {
      return;
    }
    this.lastKey = key;
    this.lastTime = now;
    const ratio = window.devicePixelRatio;
    const [width, height] = [Math.round(box.width * ratio), Math.round(box.height * ratio)];
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    const context = canvas.getContext('2d') as CanvasRenderingContext2D;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, box.width, box.height);
    const signal = app.state.telemetry.peek()?.signals.find((candidate) => candidate.name === name);
    const rows = signal?.count ?? 0;
    if (rows === 0) {
      return;
    }
    const columns = Math.max(1, Math.min(Math.floor(box.width - axisWidth), Math.ceil((range.to - range.from) / history.stride)));
    const scale = history.rings.get(name)?.scale ?? 1;
    const magnitude = largestMagnitude(history, name, range.from, range.to) * scale;
    // The scale ends at a round number, so that it does not change with every value.
    const limit = magnitude === 0 ? 1 : Math.ceil(magnitude / roundStep(magnitude / 4)) * roundStep(magnitude / 4);
    const theme = chartTheme(isDark.peek());
    const pixels = this.image.resize(columns, rows);
    fillStrip({ pixels, columns, rows }, history, name, range.from, range.to, limit / scale, theme.strip);
    this.image.draw(context, axisWidth, box.width - axisWidth, box.height);
    this.drawLabels(context, box.height, rows, hovered, (index) => valueName(app.state.robot.peek(), signal, index));
    this.drawMarks(context, box, rows, hovered, time.cursor.peek(), range);
    drawTimeMarks(context, app.marks, { left: axisWidth, width: box.width - axisWidth, height: box.height }, range);
    if (this.legend.current !== null) {
      this.legend.current.textContent = `±${formatMeasured(limit).replace(/\.?0+$/, '')} ${signal?.unit ?? ''}`;
    }
  }

  private drawLabels(
    context: CanvasRenderingContext2D,
    height: number,
    rows: number,
    hovered: number | null,
    nameOf: (index: number) => string,
  ): void {
    const theme = chartTheme(isDark.peek());
    const rowHeight = height / rows;
    const every = Math.max(1, Math.ceil(smallestLabel / rowHeight));
    context.font = '11px system-ui, sans-serif';
    context.textAlign = 'right';
    context.textBaseline = 'middle';
    for (let row = 0; row < rows; row += 1) {
      const isHovered = row === hovered;
      // Names near the hovered one are left out, because there is no room for them.
      const isCovered = hovered !== null && !isHovered && Math.abs(row - hovered) < every;
      if (isHovered || (row % every === 0 && !isCovered)) {
        context.fillStyle = isHovered ? theme.highlight : theme.text;
        context.fillText(nameOf(row), axisWidth - 6, Math.max(6, Math.min(height - 6, (row + 0.5) * rowHeight)), axisWidth - 8);
      }
    }
  }

  private drawMarks(
    context: CanvasRenderingContext2D,
    box: { width: number; height: number },
    rows: number,
    hovered: number | null,
    cursor: number | null,
    range: { from: number; to: number },
  ): void {
    context.strokeStyle = chartTheme(isDark.peek()).highlight;
    context.lineWidth = 1.5;
    if (hovered !== null && hovered < rows) {
      const rowHeight = box.height / rows;
      context.strokeRect(axisWidth + 0.75, hovered * rowHeight + 0.75, box.width - axisWidth - 1.5, Math.max(1, rowHeight - 1.5));
    }
    if (cursor !== null && cursor >= range.from && cursor <= range.to) {
      const x = axisWidth + ((cursor - range.from) / (range.to - range.from)) * (box.width - axisWidth);
      context.beginPath();
      context.moveTo(x, 0);
      context.lineTo(x, box.height);
      context.stroke();
    }
  }
}

function pointAt(app: RobotView, canvas: HTMLCanvasElement, event: MouseEvent): { tick: number; row: number } {
  const box = canvas.getBoundingClientRect();
  const { from, to } = app.time.range(app.newestTick);
  const share = (event.clientX - box.left - axisWidth) / Math.max(1, box.width - axisWidth);
  const name = app.selection.strip.peek();
  const rows = app.state.telemetry.peek()?.signals.find((signal) => signal.name === name)?.count ?? 1;
  const row = Math.floor(((event.clientY - box.top) / box.height) * rows);
  return { tick: from + Math.max(0, Math.min(1, share)) * (to - from), row: Math.max(0, Math.min(rows - 1, row)) };
}

export function StripPanel({ app }: { app: RobotView }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const legend = useRef<HTMLSpanElement>(null);
  useEffect(() => {
    const drawing = new StripDrawing(app, canvas.current as HTMLCanvasElement, legend);
    const stop = onFrame((now) => drawing.draw(now));
    return () => {
      stop();
      drawing.end();
    };
  }, []);
  useEffect(() => {
    const element = canvas.current as HTMLCanvasElement;
    const zoom = (event: WheelEvent) => {
      event.preventDefault();
      app.time.zoom(Math.exp(event.deltaY * 0.002), pointAt(app, element, event).tick, app.newestTick);
    };
    element.addEventListener('wheel', zoom, { passive: false });
    return () => element.removeEventListener('wheel', zoom);
  }, []);
  const theme = chartTheme(isDark.value);
  const signals = (app.state.telemetry.value?.signals ?? []).filter((signal) => signal.of !== 'robot');
  const rows = signals.find((signal) => signal.name === app.selection.strip.value)?.count ?? 0;
  const height = Math.max(smallestHeight, Math.min(largestHeight, rows * jointHeight));
  const point = (event: MouseEvent) => {
    const { tick, row } = pointAt(app, canvas.current as HTMLCanvasElement, event);
    app.selection.hoveredJoint.value = row;
    // A pressed button draws the cursor along.
    if (event.buttons === 1) {
      app.time.pick(tick);
    } else {
      app.time.hover(tick);
    }
  };
  const leave = () => {
    app.selection.hoveredJoint.value = null;
    app.time.leave();
  };
  return (
    <section class="panel strip-panel" aria-label="Strip: all joints over time">
      <div class="panel-head">
        <label>
          All joints over time{' '}
          <select value={app.selection.strip.value} onChange={(event) => (app.selection.strip.value = event.currentTarget.value)}>
            {signals.map((signal) => (
              <option key={signal.name} value={signal.name}>
                {signalTitle(signal)}
              </option>
            ))}
          </select>
        </label>
        <span class="space" />
        <i class="scale-bar" aria-hidden="true" style={{ background: `linear-gradient(to right, ${theme.low}, ${theme.middle}, ${theme.high})` }} />
        <span ref={legend} class="hint" title="Ends of the colour scale" />
      </div>
      <canvas
        ref={canvas}
        class="strip"
        style={{ height: `${height}px` }}
        role="img"
        aria-label="Space-time strip: a row for each joint, time from left to right"
        data-testid="strip"
        onPointerDown={(event) => {
          event.currentTarget.setPointerCapture(event.pointerId);
          point(event);
        }}
        onPointerMove={point}
        onPointerLeave={leave}
      />
    </section>
  );
}
