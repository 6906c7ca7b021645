// The server's end of a WebSocket (RFC 6455), as much of it as a test needs: messages of one frame, no extensions.
import { createHash } from 'node:crypto';
import type { IncomingMessage } from 'node:http';
import type { Duplex } from 'node:stream';

const guid = '258EAFA5-E914-47DA-95CA-C5AB0DC85B11';
const textFrame = 1;
const binaryFrame = 2;
const closeFrame = 8;

export class WebSocketPeer {
  onText: (text: string) => void = () => {};
  private received = Buffer.alloc(0);

  constructor(
    request: IncomingMessage,
    private readonly stream: Duplex,
  ) {
    const key = createHash('sha1').update(`${request.headers['sec-websocket-key']}${guid}`).digest('base64');
    stream.write(
      `HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: ${key}\r\n\r\n`,
    );
    stream.on('data', (chunk: Buffer) => this.read(chunk));
    stream.on('error', () => {});
  }

  get isOpen(): boolean {
    return this.stream.writable;
  }

  sendText(text: string): void {
    this.send(textFrame, Buffer.from(text));
  }

  sendBinary(bytes: ArrayBuffer): void {
    this.send(binaryFrame, Buffer.from(bytes));
  }

  end(): void {
    this.stream.destroy();
  }

  private send(code: number, bytes: Buffer): void {
    const head = bytes.length < 126 ? Buffer.alloc(2) : bytes.length < 65536 ? Buffer.alloc(4) : Buffer.alloc(10);
    head[0] = 0x80 | code;
    if (head.length === 2) {
      head[1] = bytes.length;
    } else if (head.length === 4) {
      head[1] = 126;
      head.writeUInt16BE(bytes.length, 2);
    } else {
      head[1] = 127;
      head.writeBigUInt64BE(BigInt(bytes.length), 2);
    }
    if (this.isOpen) this.stream.write(Buffer.concat([head, bytes]));
  }

  private read(chunk: Buffer): void {
    this.received = Buffer.concat([this.received, chunk]);
    for (let frame = this.nextFrame(); frame !== null; frame = this.nextFrame()) {
      if (frame.code === closeFrame) this.end();
      if (frame.code === textFrame) this.onText(frame.bytes.toString());
    }
  }

  // Browsers mask all frames.
  private nextFrame(): { code: number; bytes: Buffer } | null {
    const data = this.received;
    if (data.length < 2) {
      return null;
    }
    const short = (data[1] as number) & 0x7f;
    const start = short === 126 ? 4 : short === 127 ? 10 : 2;
    if (data.length < start + 4) {
      return null;
    }
    const length = short === 126 ? data.readUInt16BE(2) : short === 127 ? Number(data.readBigUInt64BE(2)) : short;
    const end = start + 4 + length;
    if (data.length < end) {
      return null;
    }
    const mask = data.subarray(start, start + 4);
    const bytes = Buffer.from(data.subarray(start + 4, end)).map((byte, i) => byte ^ (mask[i % 4] as number));
    this.received = data.subarray(end);
    return { code: (data[0] as number) & 0x0f, bytes: Buffer.from(bytes) };
  }
}
