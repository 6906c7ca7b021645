// Makes binary messages of telemetry as docs/page-interface.md describes them.
import type { Signal } from '../../../../host/page/source/wire/messages.js';

export interface MessageFields {
  subscription?: number;
  tick: number;
  stride?: number;
  run?: number;
  hasGap?: boolean;
  rows: number[][];
}

export function encodeTelemetry({ subscription = 1, tick, stride = 1, run = 1, hasGap = false, rows }: MessageFields): ArrayBuffer {
  const width = rows[0]?.length ?? 0;
  const buffer = new ArrayBuffer(16 + 4 * width * rows.length);
  const view = new DataView(buffer);
  view.setUint32(0, subscription, true);
  view.setUint32(4, tick, true);
  view.setUint16(8, rows.length, true);
  view.setUint16(10, stride, true);
  view.setUint16(12, run, true);
  view.setUint16(14, hasGap ? 1 : 0, true);
  rows.flat().forEach((value, i) => view.setInt32(16 + 4 * i, value, true));
  return buffer;
}

export function makeSignal(name: string, count: number, scale = 1): Signal {
  return { name, unit: '', scale, count, of: 'joint' };
}
