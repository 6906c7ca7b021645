// Names of the values of a signal for people: those of joints and links.
import type { RobotDocument, Signal } from '../wire/messages.js';

const poseParts = ['x', 'y', 'z', 'qw', 'qx', 'qy', 'qz'];

export function valueName(robot: RobotDocument | null, signal: Signal | undefined, index: number): string {
  if (signal?.of === 'link') {
    return robot?.links[index]?.name ?? `link ${index + 1}`;
  }
  if (signal?.of === 'robot') {
    const part = poseParts[index % poseParts.length] ?? '';
    if (signal.name === 'object') {
      const object = Math.floor(index / poseParts.length);
      return `${robot?.objects?.[object]?.name ?? `object ${object + 1}`} ${part}`;
    }
    return signal.name === 'head' ? part : `value ${index + 1}`;
  }
  // An internal value has one value for each joint of its slot.
  const slot = robot?.slots.find((candidate) => signal?.name.startsWith(`${candidate.number}/`));
  const joint = slot === undefined ? index : (slot.joints[index] ?? index);
  return robot?.joints[joint]?.name ?? `joint ${joint + 1}`;
}

export function signalTitle(signal: Signal): string {
  return `${signal.name.replace(/_/g, ' ')}${signal.unit === '' ? '' : ` (${signal.unit})`}`;
}
