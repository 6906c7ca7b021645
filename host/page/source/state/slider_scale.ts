// The way of a slider. Most of it is the useful range of the parameter; what is outside is compressed at the ends, so that
// every value stays within reach.
import { sliderStep } from './parameter_values.js';
import type { Parameter } from '../wire/messages.js';

export type ScaledParameter = Pick<Parameter, 'minimum' | 'maximum' | 'scale' | 'useful'>;

// Part of the way for all values on one side of the useful range, at most: they never get more than their linear part.
const outerPart = 0.15;

// A value and its position on the way, from 0 to 1.
type Knot = readonly [value: number, position: number];

// The straight line from knot to knot; `from` and `to` are the places of argument and result in a knot.
function interpolate(knots: readonly Knot[], argument: number, from: 0 | 1, to: 0 | 1): number {
  const next = Math.max(1, knots.findIndex((knot) => argument <= knot[from]));
  const start = knots[next - 1] as Knot;
  const end = knots[next] as Knot;
  const span = end[from] - start[from];
  const share = span > 0 ? (argument - start[from]) / span : 0;
  return start[to] + share * (end[to] - start[to]);
}

export class SliderScale {
  readonly step: number; // in the unit of the parameter
  // The ends of the useful range on the way that are not the ends of the way.
  readonly marks: readonly number[];
  private readonly low: number;
  private readonly high: number;
  private readonly knots: readonly Knot[];

  constructor(parameter: ScaledParameter) {
    const { minimum, maximum, scale, useful = [minimum, maximum] } = parameter;
    this.step = sliderStep(parameter);
    this.low = minimum * scale;
    this.high = maximum * scale;
    const range = Math.max(this.high - this.low, Number.MIN_VALUE);
    const [lower, upper] = useful.map((raw) => Math.max(this.low, Math.min(this.high, raw * scale))) as [number, number];
    const inner: Knot[] = [
      [lower, Math.min(outerPart, (lower - this.low) / range)],
      [upper, 1 - Math.min(outerPart, (this.high - upper) / range)],
    ];
    this.knots = [[this.low, 0], ...inner.filter(([, position]) => position > 0 && position < 1), [this.high, 1]];
    this.marks = this.knots.slice(1, -1).map(([, position]) => position);
  }

  positionOf(value: number): number {
    return interpolate(this.knots, this.limited(value), 0, 1);
  }

  // The value at a position, a whole number of steps above the lowest one, or the highest one.
  valueAt(position: number): number {
    if (position >= 1) return this.high;
    return this.snapped(interpolate(this.knots, Math.max(0, position), 1, 0));
  }

  // The value that is this number of steps away.
  stepped(value: number, steps: number): number {
    return this.limited(this.snapped(value) + steps * this.step);
  }

  private snapped(value: number): number {
    return this.limited(this.low + Math.round((value - this.low) / this.step) * this.step);
  }

  private limited(value: number): number {
    return Math.max(this.low, Math.min(this.high, value));
  }
}
