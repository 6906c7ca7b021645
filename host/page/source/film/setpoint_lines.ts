// The set-points of all joints as lines that run to the left; the present is at the right.
import type { TelemetryHistory } from '../data/telemetry_history.js';
import type { ChartTheme } from '../panels/chart_theme.js';
import { noValue, type RobotDocument } from '../wire/messages.js';

// Over the whole width of a picture; pixels.
export interface Band {
  top: number;
  width: number;
  height: number;
}

// Ticks. Where the recording begins later than `to` - `length`, nothing is drawn.
export interface Span {
  from: number;
  to: number;
  length: number;
}

const margin = 20; // pixels
const titleHeight = 26;
const faded = 0.35; // share of the width in which the lines fade
const step = 10; // degrees: the scale is a multiple of it

export function drawSetpoints(
  context: CanvasRenderingContext2D,
  { top, width, height }: Band,
  history: TelemetryHistory,
  robot: RobotDocument,
  { from, to, length }: Span,
  theme: ChartTheme,
  ground: string,
): void {
  const unit = history.rings.get('setpoint')?.scale ?? 0;
  const degrees = (joint: number, tick: number) => {
    const raw = history.valueAt('setpoint', joint, history.rowAtTick(tick));
    return raw === noValue ? 0 : raw * unit;
  };
  const ticks = Array.from({ length: to - from + 1 }, (_, i) => from + i);
  const values = robot.joints.map((_, joint) => ticks.map((tick) => degrees(joint, tick)));
  const largest = Math.max(step, ...values.flat().map(Math.abs));
  const scale = Math.ceil(largest / step) * step;
  const [left, right, middle] = [margin, width - margin, top + (height + titleHeight - margin / 2) / 2];
  const x = (tick: number) => right - ((to - tick) / length) * (right - left);
  const y = (value: number) => middle - (value / scale) * ((height - titleHeight - margin) / 2);

  context.fillStyle = ground;
  context.fillRect(0, top, width, height);
  context.fillStyle = theme.grid;
  context.fillRect(left, Math.round(middle), right - left, 1);
  context.lineJoin = 'round';
  context.lineWidth = 2;
  // The head, which is drawn last, is in front.
  values.forEach((_, i) => {
    const joint = values.length - 1 - i;
    const line = values[joint] as number[];
    const colour = theme.lines[joint % theme.lines.length] as string;
    const fading = context.createLinearGradient(left, 0, left + (right - left) * faded, 0);
    fading.addColorStop(0, `${colour}00`);
    fading.addColorStop(1, colour);
    context.strokeStyle = fading;
    context.beginPath();
    line.forEach((value, at) => context.lineTo(x(ticks[at] as number), y(value)));
    context.stroke();
    context.fillStyle = colour;
    context.beginPath();
    context.arc(right, y(line.at(-1) as number), 4, 0, 2 * Math.PI);
    context.fill();
  });
  context.font = '13px "DejaVu Sans", sans-serif';
  context.fillStyle = theme.text;
  context.textBaseline = 'top';
  context.fillText(`set-points of ${robot.joints.length} joints`, left, top + 8);
}
