// What the panels show: the signal of the strip, groups of lines, the joint under the pointer.
import { signal } from '@preact/signals-core';
import type { Signal } from '../wire/messages.js';

export interface Line {
  signal: string;
  index: number; // joint or link
}

export interface LineGroup {
  number: number; // ascending; never used twice
  lines: readonly Line[];
}

export const mostLines = 8;

// The 3D view and the table of joints need these.
const baseSignals = ['angle', 'setpoint', 'head', 'object', 'contact', 'current', 'torque', 'simulated_angle'];

export class SignalSelection {
  readonly strip = signal('angle');
  readonly groups = signal<readonly LineGroup[]>([{ number: 1, lines: [{ signal: 'angle', index: 0 }] }]);
  // Signals of panels beside strip and lines.
  readonly more = signal<readonly string[]>([]);
  readonly hoveredJoint = signal<number | null>(null);
  private lastGroup = 1;

  // The first plot has these signals of the first joint, until the user has chosen.
  begin(signals: readonly string[]): void {
    if (this.groups.value.length === 1 && this.groups.value[0]?.lines.length === 1) {
      this.groups.value = [{ number: 1, lines: signals.map((name) => ({ signal: name, index: 0 })) }];
    }
  }

  addGroup(): void {
    this.lastGroup += 1;
    this.groups.value = [...this.groups.value, { number: this.lastGroup, lines: [] }];
  }

  removeGroup(number: number): void {
    this.groups.value = this.groups.value.filter((group) => group.number !== number);
  }

  // Adds the line, or removes it. A full group stays as it is.
  toggle(number: number, line: Line): void {
    this.groups.value = this.groups.value.map((group) => {
      if (group.number !== number) {
        return group;
      }
      const others = group.lines.filter((other) => other.signal !== line.signal || other.index !== line.index);
      if (others.length < group.lines.length) {
        return { ...group, lines: others };
      }
      return group.lines.length >= mostLines ? group : { ...group, lines: [...group.lines, line] };
    });
  }

  // The signals to subscribe to, of those that the robot has.
  needed(signals: readonly Signal[]): Signal[] {
    const names = new Set([...baseSignals, this.strip.value, ...this.more.value]);
    for (const group of this.groups.value) {
      group.lines.forEach((line) => names.add(line.signal));
    }
    return signals.filter((candidate) => names.has(candidate.name));
  }
}
