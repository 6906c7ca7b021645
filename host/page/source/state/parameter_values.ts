// Values of parameters as text and as words of `--set`.
import type { Parameter } from '../wire/messages.js';

// The greatest number that is 1, 2 or 5 times a power of ten and at most `size`.
export function roundStep(size: number): number {
  if (!(size > 0)) {
    return 1;
  }
  const power = 10 ** Math.floor(Math.log10(size));
  const factor = [5, 2, 1].find((candidate) => candidate * power <= size * (1 + 1e-9)) ?? 1;
  return factor * power;
}

export function decimalsOf(step: number): number {
  return Math.max(0, Math.min(9, Math.ceil(-Math.log10(step) - 1e-9)));
}

export type ParameterRange = Pick<Parameter, 'minimum' | 'maximum' | 'scale'>;

// The step of a slider: about 400 steps over the range.
export function sliderStep(parameter: ParameterRange): number {
  return roundStep(((parameter.maximum - parameter.minimum) * parameter.scale) / 400);
}

// The text of a value without a fraction that only the number format has: 39.99999997 is 40. It has one decimal more than
// the slider's step, so that a typed value is shown as typed.
export function formatRaw(raw: number, parameter: ParameterRange): string {
  return formatNumber(raw * parameter.scale, decimalsOf(sliderStep(parameter)) + 2);
}

export function formatNumber(value: number, decimals: number): string {
  const text = value.toFixed(decimals);
  const short = text.includes('.') ? text.replace(/\.?0+$/, '') : text;
  return short === '-0' ? '0' : short;
}

// The text with about four digits, for values of telemetry whose size is not known beforehand.
export function formatMeasured(value: number): string {
  const size = Math.abs(value);
  return value.toFixed(size >= 1000 ? 0 : size >= 100 ? 1 : size >= 10 ? 2 : 3);
}

// Reads a number; returns a text that says what is wrong otherwise.
export function parseNumber(text: string): number | string {
  const trimmed = text.trim().replace(',', '.');
  const value = Number(trimmed);
  return trimmed === '' || !Number.isFinite(value) ? `found '${text}', expected a number` : value;
}

// Reads a number in the parameter's unit; returns a text that says what is wrong otherwise. An angle that wraps has no
// limits.
export function parseValue(text: string, parameter: ParameterRange & Pick<Parameter, 'unit' | 'wraps'>): number | string {
  const value = parseNumber(text);
  if (typeof value === 'string' || parameter.wraps) {
    return value;
  }
  const low = parameter.minimum * parameter.scale;
  const high = parameter.maximum * parameter.scale;
  // The tolerance is half a unit of the last place, because the limits themselves are rounded.
  const slack = Math.abs(parameter.scale) / 2;
  if (value < low - slack || value > high + slack) {
    const range = `${formatRaw(parameter.minimum, parameter)} to ${formatRaw(parameter.maximum, parameter)}`;
    return `found ${text.trim()}, expected ${range} ${parameter.unit}`.trimEnd();
  }
  return value;
}

// The name of a parameter for all joints of the slot, or for one: `1.amplitude`, `1.amplitude:J2`.
export function placeName(parameter: Pick<Parameter, 'slot' | 'name'>, joint: string | null): string {
  return `${parameter.slot}.${parameter.name}${joint === null ? '' : `:${joint}`}`;
}

export function setWord(parameter: Pick<Parameter, 'slot' | 'name'>, joint: string | null, value: number): string {
  return `${placeName(parameter, joint)}=${plainDecimal(value)}`;
}

// `--set` takes decimal text without an exponent.
function plainDecimal(value: number): string {
  return formatNumber(value, 9);
}

// The help text of a parameter: an everyday sentence, then details, which may be none.
export function splitHelp(help: string): { sentence: string; details: string } {
  const [sentence, ...details] = help.split(/(?<=[.?!])\s+/);
  return { sentence: sentence ?? '', details: details.join(' ') };
}

export interface ParameterSummary {
  isUniform: boolean; // one wanted value on all joints
  isChanged: boolean; // a wanted value differs from the file's
  changed: boolean[];
  confirmed: number; // joints whose module has confirmed the wanted value
  tick: number; // tick from which all confirmed values hold
}

export function summarise(parameter: Parameter): ParameterSummary {
  const changed = parameter.wanted.map((value, i) => value !== parameter.file[i]);
  return {
    isUniform: parameter.wanted.every((value) => value === parameter.wanted[0]),
    isChanged: changed.some(Boolean),
    changed,
    confirmed: parameter.wanted.filter((value, i) => value === parameter.confirmed[i]).length,
    tick: Math.max(0, ...parameter.tick),
  };
}
