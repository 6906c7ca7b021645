// The one row of a robot that stands still, for panels that show a robot.
import { TelemetryHistory } from '../data/telemetry_history.js';
import type { Signal } from '../wire/messages.js';
import { rowLayout } from '../wire/subscription.js';

const micrometre = 1e-6;
const quaternionUnit = 2 ** 30;

export class StillRows {
  readonly history = new TelemetryHistory();
  private run = 0;

  // Straight, with its head at a place: x, y, z and a quaternion; null: on the ground.
  place(head: readonly number[] | null, joints: number): void {
    const signals: Signal[] = [
      ...(head === null ? [] : [{ name: 'head', unit: '', scale: 1, count: 7, of: 'robot' } as const]),
      { name: 'angle', unit: 'degree', scale: 1, count: joints, of: 'joint' },
    ];
    const values = Int32Array.from([
      ...(head ?? []).map((value, i) => Math.round(value / (i < 3 ? micrometre : 1 / quaternionUnit))),
      ...new Array<number>(joints).fill(0),
    ]);
    this.run += 1;
    const message = { subscription: 0, tick: 0, rows: 1, stride: 1, run: this.run, hasGap: false, width: values.length, values };
    this.history.append(message, rowLayout(signals));
  }
}
