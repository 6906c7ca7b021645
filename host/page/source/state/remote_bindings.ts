// Bindings of a remote control, as the page edits them.
import type { Parameter, RemoteBinding, RemoteDocument, RemoteElement, RemoteValues } from '../wire/messages.js';
import { formatNumber, parseNumber, placeName, roundStep } from './parameter_values.js';

export const actionTitles: Record<string, string> = {
  hold_to_run: 'hold to run',
  run: 'run',
  pause: 'pause',
  step: 'step',
  restart: 'restart',
  stop: 'STOP',
};

// The element that `remote.learn` has found.
export interface LearnedElement extends RemoteElement {
  device: string;
}

export function readLearned(value: unknown): LearnedElement | null {
  const learned = value as { device?: unknown; element?: unknown; kind?: unknown } | null;
  if (typeof learned?.device !== 'string' || typeof learned.element !== 'string') {
    return null;
  }
  return { device: learned.device, name: learned.element, kind: learned.kind === 'axis' ? 'axis' : 'button' };
}

// All values that a parameter may have, in steps of about a hundredth.
function wholeRange(parameter: Parameter): { lower: number; upper: number; step: number } {
  const decimals = 6;
  const low = parameter.wraps ? -180 : parameter.minimum * parameter.scale;
  const high = parameter.wraps ? 180 : parameter.maximum * parameter.scale;
  return {
    lower: Number(formatNumber(low, decimals)),
    upper: Number(formatNumber(high, decimals)),
    step: roundStep((high - low) / 100),
  };
}

// The binding with which a new element begins: the one that a person most likely wants.
export function firstBinding(element: LearnedElement, parameters: readonly Parameter[]): RemoteBinding {
  const { device, name } = element;
  const parameter = parameters[0];
  return element.kind === 'axis' && parameter !== undefined
    ? parameterBinding({ device, element: name, action: 'hold_to_run' }, parameter)
    : { device, element: name, action: 'hold_to_run' };
}

// The binding of the same element to a parameter.
export function parameterBinding(binding: RemoteBinding, parameter: Parameter): RemoteBinding {
  const { device, element } = binding;
  const range = wholeRange(parameter);
  return { device, element, parameters: [placeName(parameter, null)], method: 'linear', ...range, dead_zone: 0, curve: 1, take_up: true };
}

// The binding of the same element to an action.
export function actionBinding({ device, element }: RemoteBinding, action: string): RemoteBinding {
  return { device, element, action };
}

// The names in a text field, which blanks or commas separate.
export function parameterNames(text: string): string[] {
  return text.split(/[\s,]+/).filter((name) => name !== '');
}

export type NumberField = 'lower' | 'upper' | 'step' | 'dead_zone' | 'curve';

// The binding with another number, or a text that says what is wrong.
export function withNumber(binding: RemoteBinding, field: NumberField, text: string): RemoteBinding | string {
  const value = parseNumber(text);
  return typeof value === 'string' ? value : { ...binding, [field]: value };
}

// The position of an element, -1 to 1 (of a button: 0 or 1); null: the device has gone.
export function positionOf(values: RemoteValues | null, device: number, element: number): number | null {
  return values?.devices.find(({ id }) => id === device)?.positions[element] ?? null;
}

// One line about a remote control for those who do not look at its details.
export function describeRemote(remote: RemoteDocument | null): string {
  if (remote === null || remote.devices.length === 0) {
    return 'no device';
  }
  const devices = remote.devices.length === 1 ? (remote.devices[0]?.name ?? '') : `${remote.devices.length} devices`;
  return remote.active ? devices : `${devices}; no effect: nobody drives`;
}
