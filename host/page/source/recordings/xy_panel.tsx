// One series over another one, in the part of the recording that is shown.
import { useSignal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import { onFrame } from '../view/frame_clock.js';
import { chartTheme } from '../panels/chart_theme.js';
import { signalTitle, valueName } from '../panels/value_names.js';
import { formatMeasured } from '../state/parameter_values.js';
import type { Line } from '../state/signal_selection.js';
import { isDark } from '../view/theme.js';
import { noValue, type Signal } from '../wire/messages.js';
import type { OpenedRecording } from './opened_recording.js';

const height = 260; // CSS pixels
const edge = { left: 62, right: 12, top: 10, bottom: 26 };
const framePeriod = 50; // milliseconds

interface Points {
  x: number[];
  y: number[];
}

function pointsOf(app: OpenedRecording, x: Line, y: Line): Points {
  const { sampledRows: rows, time } = app;
  const { from, to } = time.range();
  const points: Points = { x: [], y: [] };
  const scale = (line: Line) => rows.rings.get(line.signal)?.scale ?? 1;
  const [xScale, yScale] = [scale(x), scale(y)];
  for (let row = rows.rowAtTick(from); row < rows.end && rows.tickOf(row) <= to; row += 1) {
    const [xRaw, yRaw] = [rows.valueAt(x.signal, x.index, row), rows.valueAt(y.signal, y.index, row)];
    if (xRaw !== noValue && yRaw !== noValue) {
      points.x.push(xRaw * xScale);
      points.y.push(yRaw * yScale);
    }
  }
  return points;
}

function limits(values: readonly number[]): [number, number] {
  const [low, high] = values.reduce(([least, most], value) => [Math.min(least, value), Math.max(most, value)], [Infinity, -Infinity]);
  const room = high > low ? (high - low) * 0.05 : 1;
  return values.length === 0 ? [-1, 1] : [low - room, high + room];
}

function draw(app: OpenedRecording, canvas: HTMLCanvasElement, x: Line, y: Line): void {
  const ratio = window.devicePixelRatio;
  const width = canvas.clientWidth;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  const context = canvas.getContext('2d') as CanvasRenderingContext2D;
  const theme = chartTheme(isDark.peek());
  context.scale(ratio, ratio);
  const points = pointsOf(app, x, y);
  const [[xLow, xHigh], [yLow, yHigh]] = [limits(points.x), limits(points.y)];
  const [right, bottom] = [width - edge.right, height - edge.bottom];
  const pixelX = (value: number) => edge.left + ((value - xLow) / (xHigh - xLow)) * (right - edge.left);
  const pixelY = (value: number) => bottom - ((value - yLow) / (yHigh - yLow)) * (bottom - edge.top);
  context.strokeStyle = theme.grid;
  context.strokeRect(edge.left, edge.top, right - edge.left, bottom - edge.top);
  context.fillStyle = theme.text;
  context.font = '11px system-ui, sans-serif';
  for (let step = 0; step <= 4; step += 1) {
    const [xValue, yValue] = [xLow + ((xHigh - xLow) * step) / 4, yLow + ((yHigh - yLow) * step) / 4];
    context.textAlign = step === 0 ? 'left' : step === 4 ? 'right' : 'center';
    context.textBaseline = 'top';
    context.fillText(formatMeasured(xValue), pixelX(xValue), bottom + 6);
    context.textAlign = 'right';
    context.textBaseline = 'middle';
    context.fillText(formatMeasured(yValue), edge.left - 6, pixelY(yValue));
  }
  // Rows of every tick are drawn as a curve; samples that are some ticks apart are drawn as points.
  context.strokeStyle = context.fillStyle = theme.lines[0] ?? theme.text;
  context.beginPath();
  points.x.forEach((value, i) => {
    const [px, py] = [pixelX(value), pixelY(points.y[i] as number)];
    if (app.sampledRows.stride > 1) {
      context.fillRect(px - 1, py - 1, 2, 2);
    } else {
      context.lineTo(px, py);
    }
  });
  context.stroke();
  const { rowsAtCursor: rows } = app;
  const row = rows.rowAtTick(app.time.shownTick());
  const at = (line: Line) => rows.valueAt(line.signal, line.index, row);
  if (at(x) !== noValue && at(y) !== noValue) {
    const scale = (line: Line) => rows.rings.get(line.signal)?.scale ?? 1;
    context.fillStyle = theme.highlight;
    context.beginPath();
    context.arc(pixelX(at(x) * scale(x)), pixelY(at(y) * scale(y)), 5, 0, 2 * Math.PI);
    context.fill();
  }
}

function Choice({ app, name, line, choose }: { app: OpenedRecording; name: string; line: Line; choose: (line: Line) => void }) {
  const signals = app.state.telemetry.value?.signals ?? [];
  const signal = signals.find((candidate) => candidate.name === line.signal);
  const count = (candidate: Signal | undefined) => Array.from({ length: candidate?.count ?? 0 }, (_, index) => index);
  return (
    <span>
      <label>
        {name}{' '}
        <select value={line.signal} onChange={(event) => choose({ signal: event.currentTarget.value, index: 0 })}>
          {signals.map((candidate) => (
            <option key={candidate.name} value={candidate.name}>
              {signalTitle(candidate)}
            </option>
          ))}
        </select>
      </label>{' '}
      <select
        aria-label={`${name}: which one`}
        value={String(line.index)}
        onChange={(event) => choose({ signal: line.signal, index: Number(event.currentTarget.value) })}
      >
        {count(signal).map((index) => (
          <option key={index} value={String(index)}>
            {valueName(app.state.robot.value, signal, index)}
          </option>
        ))}
      </select>
    </span>
  );
}

export function XyPanel({ app }: { app: OpenedRecording }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const x = useSignal<Line>({ signal: 'setpoint', index: 0 });
  const y = useSignal<Line>({ signal: 'angle', index: 0 });
  useEffect(() => {
    app.selection.more.value = [x.value.signal, y.value.signal];
    let lastKey = '';
    let last = 0;
    return onFrame((now) => {
      const { from, to } = app.time.range();
      const { sampledRows: rows, rowsAtCursor } = app;
      const key = [rows.run, rows.end, rowsAtCursor.run, from, to, app.time.shownTick(), isDark.peek(), canvas.current?.clientWidth].join();
      if (key !== lastKey && now - last > framePeriod && canvas.current !== null && canvas.current.clientWidth > 100) {
        lastKey = key;
        last = now;
        draw(app, canvas.current, x.value, y.value);
      }
    });
  }, [x.value, y.value]);
  return (
    <section class="panel xy-panel" aria-label="One series over another">
      <div class="panel-head">
        <Choice app={app} name="x" line={x.value} choose={(line) => (x.value = line)} />
        <Choice app={app} name="y" line={y.value} choose={(line) => (y.value = line)} />
      </div>
      <canvas ref={canvas} style={{ width: '100%', height: `${height}px` }} role="img" aria-label="One series over another" data-testid="xy" />
    </section>
  );
}
