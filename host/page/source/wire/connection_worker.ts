// The worker that has the WebSocket. The main thread may hang; beats and pings continue, and the beats contain its duration.
import type { ResultMessage, ServerMessage } from './messages.js';
import {
  Connection,
  type ConnectionEvents,
  type ConnectionPorts,
  type ConnectionStatus,
  type OperationRequest,
} from './connection.js';
import { openSocket } from './web_socket.js';

export type ToConnectionWorker =
  | { kind: 'open'; url: string; token: string; name: string; wantsControl: boolean }
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
const signPeriod = 100;

const post = (message: FromConnectionWorker, transfer: Transferable[] = []) => self.postMessage(message, { transfer });

let connection: Connection | null = null;

self.onmessage = (event: MessageEvent<ToConnectionWorker>) => {
  const message = event.data;
  if (message.kind === 'open') {
    const ports: ConnectionPorts = {
      openSocket: (events) => openSocket(message.url, events),
      now: () => performance.now(),
      after: (ms, action) => void setTimeout(action, ms),
    };
    const events: ConnectionEvents = {
      status: (status) => post({ kind: 'status', status }),
      message: (received) => post({ kind: 'message', message: received }),
      telemetry: (buffer) => post({ kind: 'telemetry', buffer }, [buffer]),
      result: (key, result) => post({ kind: 'result', key, result }, result.value instanceof ArrayBuffer ? [result.value] : []),
      latency: (ms) => post({ kind: 'latency', ms }),
    };
    connection = new Connection(message.token, message.name, ports, events, message.wantsControl);
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
