// The other end of a socket: notes what is sent, and lets a test answer.
import type { Socket, SocketEvents } from '../../../../host/page/source/wire/connection.js';

export class SocketEnd implements Socket {
  readonly sent: Record<string, unknown>[] = [];
  isClosed = false;

  constructor(readonly events: SocketEvents) {}

  send(text: string): void {
    this.sent.push(JSON.parse(text) as Record<string, unknown>);
  }

  close(): void {
    this.isClosed = true;
  }

  answer(message: object): void {
    this.events.text(JSON.stringify(message));
  }

  ofType(type: string): Record<string, unknown>[] {
    return this.sent.filter((message) => message['type'] === type);
  }
}
