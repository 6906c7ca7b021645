// Names of the values of a signal, as people know them: joints and links.
import type { RobotDocument, Signal } from '../wire/messages.js';

export function valueName(robot: RobotDocument | null, signal: Signal | undefined, index: number): string {
  if (signal?.of === 'link') {
    return robot?.links[index]?.name ?? `link ${index + 1}`;
  }
  if (signal?.of === 'robot') {
    return signal.name === 'head' ? (['x', 'y', 'z', 'qw', 'qx', 'qy', 'qz'][index] ?? '') : `value ${index + 1}`;
  }
  // An internal value has one for each joint of its slot.
  const slot = robot?.slots.find((candidate) => signal?.name.startsWith(`${candidate.number}/`));
  const joint = slot === undefined ? index : (slot.joints[index] ?? index);
  return robot?.joints[joint]?.name ?? `joint ${joint + 1}`;
}

export function signalTitle(signal: Signal): string {
  return `${signal.name.replace(/_/g, ' ')}${signal.unit === '' ? '' : ` (${signal.unit})`}`;
}
