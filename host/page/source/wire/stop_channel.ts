// The channel for STOP: a socket that is only for it, and POST /stop as a second way. Either of them suffices.
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

// The durations below are in milliseconds.
const socketPatience = 150; // time without an answer after which POST is used, too
const reopenDelay = 1000;

interface Press {
  time: number;
  resolve(outcome: StopOutcome): void;
  reject(error: Error): void;
  complete(outcome: StopOutcome): void;
  isDone: boolean; // the promise is settled; numbers may still come
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
        this.presses = this.presses.filter((press) => !press.isDone);
        this.ports.after(reopenDelay, () => this.open());
      },
    });
    this.socket = socket;
  }

  // Sends STOP. Rejects if neither way had an answer. Each press sends again: a second press must never have less effect
  // than the first. `complete` is called if the numbers come over the socket after the answer to the POST: a module that
  // does not confirm takes longer than the patience.
  press(complete: (outcome: StopOutcome) => void = () => {}): Promise<StopOutcome> {
    return new Promise((resolve, reject) => {
      const press: Press = { time: this.ports.now(), resolve, reject, complete, isDone: false };
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
      () => {
        if (press.isDone) return;
        press.isDone = true;
        press.resolve({ ms: this.ports.now() - press.time, confirmed: null, of: null });
        if (!this.isOpen) this.forget(press);
      },
      (error: Error) => {
        if (!press.isDone) {
          press.isDone = true;
          this.forget(press);
          press.reject(error);
        }
      },
    );
  }

  private receive(text: string): void {
    const message = JSON.parse(text) as ServerMessage;
    if (message.type === 'stopped') {
      const presses = this.presses;
      this.presses = [];
      for (const press of presses) {
        const outcome = { ms: this.ports.now() - press.time, confirmed: message.confirmed, of: message.of };
        if (press.isDone) {
          press.complete(outcome);
        } else {
          press.isDone = true;
          press.resolve(outcome);
        }
      }
    }
  }

  private forget(press: Press): void {
    this.presses = this.presses.filter((other) => other !== press);
  }
}
