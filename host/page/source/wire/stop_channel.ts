// STOP: a socket that is only for it, and POST /stop as second way. Either alone suffices.
import { protocol, type ClientMessage, type ServerMessage } from './messages.js';
import type { Socket, SocketEvents } from './connection.js';

export interface StopPorts {
  openSocket(events: SocketEvents): Socket;
  post(): Promise<void>; // POST /stop; rejects with an Error that says what was found
  now(): number; // milliseconds
  after(ms: number, action: () => void): void;
}

export interface StopOutcome {
  ms: number; // from the press to the first answer
  confirmed: number | null; // null: the answer came by POST, which has no numbers
  of: number | null;
}

// In milliseconds.
const socketPatience = 150; // without an answer by then, POST is used too
const reopenDelay = 1000;

interface Press {
  time: number;
  resolve(outcome: StopOutcome): void;
  reject(error: Error): void;
  isDone: boolean;
}

export class StopChannel {
  private socket: Socket | null = null;
  private isOpen = false;
  private presses: Press[] = [];

  constructor(
    private readonly token: string,
    private readonly name: string,
    private readonly ports: StopPorts,
  ) {}

  open(): void {
    const socket = this.ports.openSocket({
      opened: () => {
        this.isOpen = true;
        const hello: ClientMessage = { type: 'hello', protocol, token: this.token, name: this.name, only: 'stop' };
        socket.send(JSON.stringify(hello));
      },
      text: (text) => this.receive(text),
      binary: () => {},
      closed: () => {
        this.isOpen = false;
        this.ports.after(reopenDelay, () => this.open());
      },
    });
    this.socket = socket;
  }

  // Rejects if neither way had an answer. Each press sends anew: a second press must never be less than the first.
  press(): Promise<StopOutcome> {
    return new Promise((resolve, reject) => {
      const press: Press = { time: this.ports.now(), resolve, reject, isDone: false };
      this.presses.push(press);
      if (!this.isOpen) {
        this.post(press);
        return;
      }
      this.socket?.send(JSON.stringify({ type: 'stop' }));
      this.ports.after(socketPatience, () => {
        if (!press.isDone) this.post(press);
      });
    });
  }

  private post(press: Press): void {
    this.ports.post().then(
      () => this.finish([press], null, null),
      (error: Error) => {
        if (!press.isDone) {
          press.isDone = true;
          this.presses = this.presses.filter((other) => other !== press);
          press.reject(error);
        }
      },
    );
  }

  private receive(text: string): void {
    const message = JSON.parse(text) as ServerMessage;
    if (message.type === 'stopped') {
      this.finish(this.presses, message.confirmed, message.of);
    }
  }

  private finish(presses: Press[], confirmed: number | null, of: number | null): void {
    for (const press of presses) {
      if (!press.isDone) {
        press.isDone = true;
        press.resolve({ ms: this.ports.now() - press.time, confirmed, of });
      }
    }
    this.presses = this.presses.filter((press) => !press.isDone);
  }
}
