// A viewer that is not the page: a WebSocket (RFC 6455) on a plain TCP connection, so that it can stop reading.
import { randomBytes } from 'node:crypto';
import { connect, type Socket } from 'node:net';
import { protocol } from '../../../../host/page/source/wire/messages.js';
import { inTime } from './processes.js';

export interface TelemetryHeader {
  tick: number;
  rows: number;
  run: number;
}

export class RawViewer {
  private received = Buffer.alloc(0);
  private hasUpgraded = false;
  private lastId = 0;
  private waiting: { matches(value: any): boolean; resolve(value: any): void }[] = [];
  private upgraded: () => void = () => {};
  bytes = 0; // of telemetry messages
  texts: any[] = [];
  onTelemetry: (header: TelemetryHeader) => void = () => {};
  onText: (message: any) => void = () => {};

  private constructor(
    private readonly socket: Socket,
    readonly serverPort: number,
  ) {
    socket.on('data', (data: Buffer) => this.read(data));
    socket.on('error', () => {}); // a message that does not come is reported
  }

  get port(): number {
    return this.socket.localPort as number;
  }

  // `address`: http://127.0.0.1:PORT/#TOKEN
  static async open(address: string): Promise<RawViewer> {
    const { port, host, hash } = new URL(address);
    const socket = connect(Number(port), '127.0.0.1');
    await new Promise((resolve, reject) => socket.once('connect', resolve).once('error', reject));
    const viewer = new RawViewer(socket, Number(port));
    const key = randomBytes(16).toString('base64');
    const upgraded = new Promise<void>((resolve) => (viewer.upgraded = resolve));
    socket.write(
      `GET /socket HTTP/1.1\r\nHost: ${host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n` +
        `Sec-WebSocket-Key: ${key}\r\nSec-WebSocket-Version: 13\r\n\r\n`,
    );
    await inTime(upgraded, 'an upgrade');
    viewer.send({ type: 'hello', protocol, token: hash.slice(1), name: 'page_figures' });
    await viewer.next((message) => message.type === 'welcome');
    return viewer;
  }

  send(message: object): void {
    const payload = Buffer.from(JSON.stringify(message));
    const mask = randomBytes(4);
    const length = payload.length < 126 ? Buffer.from([0x80 | payload.length]) : Buffer.from([0x80 | 126, payload.length >> 8, payload.length & 255]);
    const masked = payload.map((byte, i) => byte ^ (mask[i % 4] as number));
    this.socket.write(Buffer.concat([Buffer.from([0x81]), length, mask, masked]));
  }

  // The first message, of those so far and those to come, that matches.
  next(matches: (message: any) => boolean): Promise<any> {
    const known = this.texts.find(matches);
    return known !== undefined
      ? Promise.resolve(known)
      : inTime(new Promise((resolve) => this.waiting.push({ matches, resolve })), 'a message of the server');
  }

  async operate(name: string, parameters: object = {}, epoch = 0): Promise<any> {
    const id = ++this.lastId;
    this.send({ type: 'operation', id, epoch, name, arguments: parameters });
    const result = await this.next((message) => message.type === 'result' && message.id === id);
    if (result.ok !== true) {
      throw new Error(`${name}: ${result.error}`);
    }
    return result.value;
  }

  // The robot's signals, all of them.
  async signals(): Promise<{ name: string; count: number }[]> {
    return (await this.next((message) => message.type === 'document' && message.name === 'telemetry')).value.signals;
  }

  // Reads no more: what the server sends fills the buffers of the kernel, then waits in the server.
  stall(): void {
    this.socket.pause();
  }

  close(): void {
    this.socket.destroy();
  }

  private read(data: Buffer): void {
    this.received = Buffer.concat([this.received, data]);
    if (!this.hasUpgraded) {
      const end = this.received.indexOf('\r\n\r\n');
      if (end < 0) return;
      this.hasUpgraded = true;
      this.upgraded();
      this.received = this.received.subarray(end + 4);
    }
    for (let payload = this.takeFrame(); payload !== null; payload = this.takeFrame());
  }

  // Null if no whole frame is there. Frames of the server are neither masked nor in parts.
  private takeFrame(): Buffer | null {
    const { received } = this;
    if (received.length < 2) return null;
    const short = (received[1] as number) & 127;
    const start = short === 127 ? 10 : short === 126 ? 4 : 2;
    if (received.length < start) return null;
    const length = short === 127 ? Number(received.readBigUInt64BE(2)) : short === 126 ? received.readUInt16BE(2) : short;
    if (received.length < start + length) return null;
    const payload = received.subarray(start, start + length);
    this.received = received.subarray(start + length);
    const opcode = (received[0] as number) & 15;
    if (opcode === 1) this.receiveText(JSON.parse(payload.toString()));
    if (opcode === 2) {
      this.bytes += payload.length;
      this.onTelemetry({ tick: payload.readUInt32LE(4), rows: payload.readUInt16LE(8), run: payload.readUInt16LE(12) });
    }
    return payload;
  }

  private receiveText(message: any): void {
    this.onText(message);
    // Results are asked for once; documents replace earlier ones.
    this.texts = this.texts.filter((known) => known.type !== message.type || known.name !== message.name || known.id !== message.id);
    this.texts.push(message);
    const found = this.waiting.filter(({ matches }) => matches(message));
    this.waiting = this.waiting.filter((waiter) => !found.includes(waiter));
    found.forEach(({ resolve }) => resolve(message));
  }
}
