// What is known of each robot of a class.
import { signal } from '@preact/signals-core';
import type { TileNews, TileRobot, TileRow, TileSession } from './tile_messages.js';

export class Tile {
  readonly isConnected = signal(false);
  readonly robot = signal<TileRobot | null>(null);
  readonly session = signal<TileSession | null>(null);
  readonly row = signal<TileRow | null>(null);

  receive({ isConnected, robot, session, row }: TileNews): void {
    if (isConnected !== undefined) this.isConnected.value = isConnected;
    if (robot !== undefined) {
      this.robot.value = robot;
      this.row.value = null;
    }
    if (session !== undefined && JSON.stringify(session) !== JSON.stringify(this.session.peek())) this.session.value = session;
    // A robot that stands still gives the same row again.
    const known = this.row.peek();
    if (row !== undefined && (row.run !== known?.run || row.tick !== known.tick || row.head.join() !== known.head.join())) this.row.value = row;
  }

  forget(): void {
    this.isConnected.value = false;
    this.session.value = null;
  }
}
