// Watches the robot of one seat: its session, and at most one row of telemetry each time it is asked to look.
import { Connection, type ConnectionPorts } from '../wire/connection.js';
import { noValue, type ServerMessage, type SessionDocument, type Signal, type TelemetryDocument } from '../wire/messages.js';
import { rowLayout, type RowLayout } from '../wire/subscription.js';
import { decodeTelemetry } from '../wire/telemetry_message.js';
import type { TileNews, TileRow, TileSession, WatchedSeat } from './tile_messages.js';

const degree = Math.PI / 180;
const micrometre = 1e-6;
const quaternionUnit = 2 ** 30;
const wanted = ['angle', 'head'];

export function tileSession(session: SessionDocument): TileSession {
  const simulation = session.kind === 'bus' ? null : session;
  return {
    state: session.state,
    speed: session.state === 'running' ? (simulation?.recent_speed ?? null) : null,
    distance: simulation?.measures?.['distance'] ?? null,
    servoProblem: simulation?.servo_problem ?? null,
    failure: session.failure,
    isRecording: session.recording !== null,
  };
}

export class SeatWatch {
  private readonly connection: Connection;
  private telemetry: TelemetryDocument | null = null;
  private layout: RowLayout = rowLayout([]);
  private lastSubscription = 0;
  private isWaiting = false; // for a row
  private news: TileNews;

  constructor(
    readonly seat: WatchedSeat,
    ports: ConnectionPorts,
  ) {
    this.news = { seat: seat.seat };
    const events = {
      status: ({ state }: { state: string }) => this.noteStatus(state === 'open'),
      message: (message: ServerMessage) => this.receive(message),
      telemetry: (buffer: ArrayBuffer) => this.receiveRows(buffer),
      result: () => {},
      latency: () => {},
    };
    this.connection = new Connection(seat.token, 'Teacher', ports, events, false);
    this.connection.open();
  }

  // Asks for the newest row, unless the last one has not come yet: a robot sends a row of each tick to who does not unsubscribe.
  look(): void {
    if (this.telemetry === null || this.isWaiting) return;
    this.isWaiting = true;
    this.subscribe(this.layout.signals.map(({ signal }) => signal.name), true);
  }

  rest(): void {
    if (this.isWaiting) this.unsubscribe();
  }

  // What is new since the last call; null: nothing.
  takeNews(): TileNews | null {
    const { news } = this;
    this.news = { seat: this.seat.seat };
    return Object.keys(news).length > 1 ? news : null;
  }

  close(): void {
    this.connection.close();
  }

  private noteStatus(isConnected: boolean): void {
    this.news.isConnected = isConnected;
    this.telemetry = null;
    this.isWaiting = false;
    this.lastSubscription = 0;
  }

  private receive(message: ServerMessage): void {
    if (message.type !== 'document') return;
    if (message.name === 'robot') {
      const { joints, links, terrain } = message.value;
      this.news.robot = { joints, links, terrain };
    } else if (message.name === 'session') {
      this.news.session = tileSession(message.value);
    } else if (message.name === 'telemetry') {
      // Each revision ends the subscription.
      this.telemetry = message.value;
      this.isWaiting = false;
      const found = wanted.map((name) => message.value.signals.find((signal) => signal.name === name));
      this.layout = rowLayout(found.filter((signal): signal is Signal => signal !== undefined));
    }
  }

  private subscribe(names: string[], newest: boolean): void {
    this.lastSubscription += 1;
    this.connection.subscribe(names, this.telemetry?.hash ?? 0, newest);
  }

  private unsubscribe(): void {
    this.isWaiting = false;
    this.subscribe([], false);
  }

  private receiveRows(buffer: ArrayBuffer): void {
    const { subscription, tick, rows, stride, run, width, values } = decodeTelemetry(buffer);
    if (subscription !== this.lastSubscription || !this.isWaiting || rows === 0) return;
    this.news.row = rowOf(this.layout, values.subarray((rows - 1) * width), run, tick + (rows - 1) * stride);
    this.unsubscribe();
  }
}

function rowOf(layout: RowLayout, values: Int32Array, run: number, tick: number): TileRow {
  const read = (name: string, scale: (signal: Signal, i: number) => number): number[] => {
    const found = layout.signals.find(({ signal }) => signal.name === name);
    if (found === undefined) return [];
    const { signal, offset } = found;
    return [...values.subarray(offset, offset + signal.count)].map((raw, i) => (raw === noValue ? 0 : raw * scale(signal, i)));
  };
  const angles = read('angle', (signal) => signal.scale * degree);
  const head = read('head', (_, i) => (i < 3 ? micrometre : 1 / quaternionUnit));
  return { run, tick, head, angles };
}
