// How a robot moves for half a minute: the draft's, and beside it that of a candidate.
import { signal } from '@preact/signals-core';
import { historyFor } from '../../data/recording_source.js';
import type { TelemetryHistory } from '../../data/telemetry_history.js';
import { wholePathOf } from '../../panels/scene_pose.js';
import { Playback } from '../../state/playback.js';
import type { ComparedView } from '../../view/robot_view.js';
import type { RobotDocument, Signal } from '../../wire/messages.js';
import { bytesResultHeader } from '../../wire/bytes_result.js';
import { rowLayout } from '../../wire/subscription.js';

const headValues = 7;
const headerBytes = 16;
const angleScale = 180 / 2 ** 31; // degrees
// The two may have ticks of different lengths: here a tick is a microsecond.
const tickRate = 1e6;

export interface Motion {
  readonly joints: number;
  readonly rows: TelemetryHistory; // ticks are microseconds
  readonly path: Float64Array; // the head in each row
  readonly end: number; // microseconds
}

// Decodes the answer of `search.motion`. Throws an Error that says what was found and what was expected.
export function decodeMotion(buffer: ArrayBuffer): Motion {
  const bytes = buffer.byteLength - bytesResultHeader;
  if (bytes < headerBytes) {
    throw new Error(`motion: found ${Math.max(0, bytes)} bytes, expected a header of ${headerBytes} bytes`);
  }
  const header = new DataView(buffer, bytesResultHeader);
  const [tick, stride, count, joints] = [0, 4, 8, 12].map((offset) => header.getUint32(offset, true)) as [number, number, number, number];
  const width = joints + headValues;
  if (count === 0 || tick * stride === 0 || bytes !== headerBytes + 4 * count * width) {
    throw new Error(`motion: found ${bytes - headerBytes} bytes, expected ${count} rows of ${joints} joints and the head, at least one`);
  }
  const signals: Signal[] = [
    { name: 'angle', unit: 'degree', scale: angleScale, count: joints, of: 'joint' },
    { name: 'head', unit: '', scale: 1, count: headValues, of: 'robot' },
  ];
  const rows = historyFor(count);
  const values = new Int32Array(buffer, bytesResultHeader + headerBytes, count * width);
  rows.append({ subscription: 0, tick: 0, rows: count, stride: stride * tick, run: 0, hasGap: false, width, values }, rowLayout(signals));
  return { joints, rows, path: wholePathOf(rows, []), end: rows.lastTick() };
}

let runs = 0; // so that the 3D view sees that another motion is shown

// Two motions that play together, round and round.
export class MotionPair {
  readonly time: Playback;
  readonly compared: ComparedView;
  readonly wholePath;

  // robot: the body of both.
  constructor(
    readonly draft: Motion,
    readonly candidate: Motion,
    readonly robot: RobotDocument,
    at: number, // microseconds
    isPlaying: boolean,
  ) {
    for (const { rows } of [draft, candidate]) rows.run = ++runs;
    this.time = new Playback(0, Math.max(draft.end, candidate.end), tickRate);
    this.time.seek(at);
    this.time.isPlaying.value = isPlaying;
    this.wholePath = draft.path;
    const { rows, path } = candidate;
    this.compared = {
      legend: 'candidate',
      reader: { robot, history: rows, rowsAtCursor: rows, wholePath: signal(path), has: (tick) => rows.has(tick) },
    };
  }

  get seconds(): number {
    return this.time.cursor.peek() / tickRate;
  }

  seekSeconds(seconds: number): void {
    this.time.seek(seconds * tickRate);
  }

  get duration(): number {
    return this.time.last / tickRate;
  }

  // To be called at each frame while it is shown.
  advance(milliseconds: number): void {
    if (!this.time.isPlaying.peek()) return;
    this.time.advance(milliseconds);
    if (!this.time.isPlaying.peek()) {
      this.time.seek(0);
      this.time.isPlaying.value = true;
    }
  }
}
