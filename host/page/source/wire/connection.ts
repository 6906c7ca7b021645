// The connection to `proleg ui`: greeting, operations and their answers, signs of life, and new attempts after a loss.
// It knows neither WebSocket nor clock: both come in through ports.
import {
  protocol,
  type ClientMessage,
  type ControlDocument,
  type Operations,
  type ResultMessage,
  type ServerMessage,
} from './messages.js';
import { answeredBy } from './bytes_result.js';

export interface Socket {
  send(text: string): void;
  close(): void;
}

export interface SocketEvents {
  opened(): void;
  text(text: string): void;
  binary(buffer: ArrayBuffer): void;
  closed(code: number, reason: string): void;
}

export interface ConnectionPorts {
  openSocket(events: SocketEvents): Socket;
  now(): number; // milliseconds, steady
  after(ms: number, action: () => void): void;
}

// connecting: no answer yet. lost: there was one, new attempts follow. ended: the program said that it ends; attempts
// follow, since it may start again. refused: the server does not accept this viewer, so there are no more attempts.
export type ConnectionStatus =
  | { state: 'connecting' }
  | { state: 'open'; client: number; program: string; nextNotice: number }
  | { state: 'lost'; attempts: number }
  | { state: 'ended' }
  | { state: 'refused'; reason: string };

export interface ConnectionEvents {
  status(status: ConnectionStatus): void;
  message(message: ServerMessage): void;
  telemetry(buffer: ArrayBuffer): void;
  result(key: number, result: ResultMessage): void;
  latency(ms: number): void; // duration of an operation that does nothing, to the session and back
}

export interface OperationRequest {
  key: number; // chosen by the caller; the answer has it
  epoch: number;
  name: keyof Operations;
  arguments: object;
}

// Period in milliseconds. For the server, a holder whose beats stop for 0.5 s is away. They come from a worker: browsers slow
// down the timers of a hidden page, but not those of its workers.
const beatPeriod = 100;
const pingPeriod = 1000;
const longestSilence = 4000;
const shortestDelay = 250;
const longestDelay = 4000;

// Close codes of RFC 6455.
const goingAway = 1001;
const policyViolation = 1008;

export class Connection {
  private socket: Socket | null = null;
  private attempt = 0; // counts sockets, so that a late event of an earlier one has no effect
  private failures = 0;
  private hasEnded = false; // the program has reported its end, and has not come back
  private client: number | null = null;
  private isHolder = false;
  private lastId = 0;
  private lastSign = 0; // when the main thread last answered
  private lastMessage = 0;
  private readonly pending = new Map<number, number>(); // id to the caller's key
  private readonly pings = new Map<number, number>(); // id to the time of sending

  constructor(
    private readonly token: string,
    private readonly name: string,
    private readonly ports: ConnectionPorts,
    private readonly events: ConnectionEvents,
    private readonly wantsControl = true,
  ) {
    this.lastSign = ports.now();
  }

  open(): void {
    const attempt = ++this.attempt;
    const ifCurrent = (action: () => void) => {
      if (attempt === this.attempt) action();
    };
    this.socket = this.ports.openSocket({
      opened: () => ifCurrent(() => this.greet()),
      text: (text) => ifCurrent(() => this.receive(text)),
      binary: (buffer) => ifCurrent(() => this.receiveBinary(buffer)),
      closed: (code, reason) => ifCurrent(() => this.lose(code, reason)),
    });
  }

  // Ends it, without new attempts.
  close(): void {
    const socket = this.socket;
    this.forgetSocket();
    socket?.close();
  }

  // Sends an operation. Returns false if there is no connection: the operation has no effect.
  operate(request: OperationRequest): boolean {
    if (this.client === null) {
      return false;
    }
    const id = ++this.lastId;
    this.pending.set(id, request.key);
    const { epoch, name } = request;
    this.send({ type: 'operation', id, epoch, name, arguments: request.arguments });
    return true;
  }

  // Subscribes to signals. `hash`: hash of the document `telemetry` that has the signals. `newest`: the newest present row
  // is sent, too.
  subscribe(signals: string[], hash: number, newest: boolean): void {
    if (this.client !== null) {
      this.send({ type: 'subscribe', signals, hash, newest });
    }
  }

  // Notes that the main thread has answered.
  noteSignOfLife(): void {
    this.lastSign = this.ports.now();
  }

  private send(message: ClientMessage): void {
    this.socket?.send(JSON.stringify(message));
  }

  private greet(): void {
    // The only viewer of a robot on this computer drives at once: the server decides whether it is that.
    const wish = this.wantsControl ? { wants_control: true } : {};
    this.send({ type: 'hello', protocol, token: this.token, name: this.name, ...wish });
  }

  private receiveBinary(buffer: ArrayBuffer): void {
    this.lastMessage = this.ports.now();
    const id = answeredBy(buffer);
    if (id === null) {
      this.events.telemetry(buffer);
    } else {
      this.receiveResult({ type: 'result', id, ok: true, value: buffer });
    }
  }

  private receive(text: string): void {
    this.lastMessage = this.ports.now();
    const message = JSON.parse(text) as ServerMessage;
    if (message.type === 'welcome') {
      this.client = message.client;
      this.failures = 0;
      this.hasEnded = false;
      this.events.status({ state: 'open', client: message.client, program: message.program, nextNotice: message.next_notice });
      this.repeatBeat(this.attempt);
      this.repeatPing(this.attempt);
    } else if (message.type === 'result') {
      this.receiveResult(message);
    } else {
      if (message.type === 'document' && message.name === 'control') {
        this.noteControl(message.value);
      }
      this.events.message(message);
    }
  }

  private receiveResult(result: ResultMessage): void {
    const sent = this.pings.get(result.id);
    if (sent !== undefined) {
      this.pings.delete(result.id);
      this.events.latency(this.ports.now() - sent);
      return;
    }
    const key = this.pending.get(result.id);
    if (key !== undefined) {
      this.pending.delete(result.id);
      this.events.result(key, result);
    }
  }

  private noteControl(control: ControlDocument): void {
    const isHolder = control.holder?.client === this.client;
    if (isHolder && !this.isHolder) {
      this.beat();
    }
    this.isHolder = isHolder;
  }

  private beat(): void {
    this.send({ type: 'beat', age_ms: Math.max(0, Math.round(this.ports.now() - this.lastSign)) });
  }

  private repeatBeat(attempt: number): void {
    if (attempt !== this.attempt || this.client === null) {
      return;
    }
    if (this.isHolder) {
      this.beat();
    }
    this.ports.after(beatPeriod, () => this.repeatBeat(attempt));
  }

  private repeatPing(attempt: number): void {
    if (attempt !== this.attempt || this.client === null) {
      return;
    }
    if (this.ports.now() - this.lastMessage > longestSilence) {
      const socket = this.socket;
      this.lose(0, '');
      socket?.close();
      return;
    }
    const id = ++this.lastId;
    this.pings.set(id, this.ports.now());
    this.send({ type: 'operation', id, epoch: 0, name: 'ping', arguments: {} });
    this.ports.after(pingPeriod, () => this.repeatPing(attempt));
  }

  private lose(code: number, reason: string): void {
    const attempt = this.forgetSocket();
    this.isHolder = false;
    this.lastId = 0;
    this.pings.clear();
    for (const key of this.pending.values()) {
      this.events.result(key, { type: 'result', id: 0, ok: false, error: 'the connection was lost before the answer' });
    }
    this.pending.clear();
    if (code === policyViolation) {
      this.events.status({ state: 'refused', reason });
      return;
    }
    this.failures += 1;
    // Later failed attempts do not change the end of the program.
    this.hasEnded ||= code === goingAway;
    this.events.status(this.hasEnded ? { state: 'ended' } : { state: 'lost', attempts: this.failures });
    this.ports.after(Math.min(longestDelay, shortestDelay * 2 ** (this.failures - 1)), () => {
      if (attempt === this.attempt) this.open();
    });
  }

  // What the socket reports from now on has no effect. Returns the number of the attempt that is then the last one.
  private forgetSocket(): number {
    this.attempt += 1;
    this.socket = null;
    this.client = null;
    return this.attempt;
  }
}
