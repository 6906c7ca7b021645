// Positions of joints on their way to the robot: at most 50 messages a second and one without an answer. Later angles of a
// joint replace earlier ones, so a slider never builds up a queue and its last value always arrives.
import { signal } from '@preact/signals-core';

export interface PosePorts {
  isPossible(): boolean; // the robot is held, and this viewer drives
  // Sends angles. Rejects if they were refused. Null: the joint stays.
  send(angles: (number | null)[], speed: number): Promise<unknown>;
  refused(reason: string): void;
  after(ms: number, action: () => void): void;
}

const period = 20; // milliseconds
export const slowest = 1; // degrees a second
export const fastest = 180;

export class PoseQueue {
  readonly speed = signal(60);
  // The last angle that was sent to each joint, in degrees, until `forget`.
  readonly targets = signal<ReadonlyMap<number, number>>(new Map());
  private next = new Map<number, number>();
  private isBusy = false;

  constructor(private readonly ports: PosePorts) {}

  get isPossible(): boolean {
    return this.ports.isPossible();
  }

  // Moves joints. `angles`: angles of joints in degrees.
  move(angles: ReadonlyMap<number, number>, joints: number): void {
    this.targets.value = new Map([...this.targets.value, ...angles]);
    angles.forEach((angle, joint) => this.next.set(joint, angle));
    void this.sendNext(joints);
  }

  // Forgets the targets and unsent angles, because the robot is no longer held, or another viewer drives.
  forget(): void {
    this.next.clear();
    if (this.targets.peek().size > 0) {
      this.targets.value = new Map();
    }
  }

  private async sendNext(joints: number): Promise<void> {
    if (this.isBusy) {
      return;
    }
    this.isBusy = true;
    while (this.next.size > 0) {
      const angles = Array.from({ length: joints }, (_, joint) => this.next.get(joint) ?? null);
      this.next = new Map();
      const pause = new Promise<void>((resolve) => this.ports.after(period, resolve));
      try {
        await this.ports.send(angles, this.speed.peek());
      } catch (error) {
        this.forget();
        this.ports.refused((error as Error).message);
      }
      await pause;
    }
    this.isBusy = false;
  }
}
