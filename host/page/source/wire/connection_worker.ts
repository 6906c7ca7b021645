// The worker that has the WebSocket. The main thread may hang; beats and pings continue, and the beats contain its duration.
import type { ResultMessage, ServerMessage } from './messages.js';
import {
  Connection,
  type ConnectionPorts,
  type ConnectionStatus,
  type OperationRequest,
  type SocketEvents,
} from './connection.js';

export type ToConnectionWorker =
  | { kind: 'open'; url: string; token: string; name: string }
  | { kind: 'operation'; request: OperationRequest }
  | { kind: 'subscribe'; signals: string[]; hash: number; newest: boolean }
  | { kind: 'alive' };

export type FromConnectionWorker =
  | { kind: 'status'; status: ConnectionStatus }
  | { kind: 'message'; message: ServerMessage }
  | { kind: 'telemetry'; buffer: ArrayBuffer }
  | { kind: 'result'; key: number; result: ResultMessage }
  | { kind: 'latency'; ms: number }
  | { kind: 'alive?' };

// Period in milliseconds at which the main thread is asked for a sign of life.
const signPeriod = 200;

const post = (message: FromConnectionWorker, transfer: Transferable[] = []) => self.postMessage(message, { transfer });

function openSocket(url: string, events: SocketEvents) {
  const socket = new WebSocket(url);
  socket.binaryType = 'arraybuffer';
  socket.onopen = () => events.opened();
  socket.onclose = (event) => events.closed(event.code, event.reason);
  socket.onmessage = (event: MessageEvent<string | ArrayBuffer>) => {
    if (typeof event.data === 'string') {
      events.text(event.data);
    } else {
      events.binary(event.data);
    }
  };
  return socket;
}

let connection: Connection | null = null;

self.onmessage = (event: MessageEvent<ToConnectionWorker>) => {
  const message = event.data;
  if (message.kind === 'open') {
    const ports: ConnectionPorts = {
      openSocket: (events) => openSocket(message.url, events),
      now: () => performance.now(),
      after: (ms, action) => void setTimeout(action, ms),
    };
    connection = new Connection(message.token, message.name, ports, {
      status: (status) => post({ kind: 'status', status }),
      message: (received) => post({ kind: 'message', message: received }),
      telemetry: (buffer) => post({ kind: 'telemetry', buffer }, [buffer]),
      result: (key, result) => post({ kind: 'result', key, result }, result.value instanceof ArrayBuffer ? [result.value] : []),
      latency: (ms) => post({ kind: 'latency', ms }),
    });
    connection.open();
    setInterval(() => post({ kind: 'alive?' }), signPeriod);
  } else if (message.kind === 'operation') {
    if (connection?.operate(message.request) !== true) {
      const result: ResultMessage = { type: 'result', id: 0, ok: false, error: 'no connection to the program' };
      post({ kind: 'result', key: message.request.key, result });
    }
  } else if (message.kind === 'subscribe') {
    connection?.subscribe(message.signals, message.hash, message.newest);
  } else {
    connection?.noteSignOfLife();
  }
};
