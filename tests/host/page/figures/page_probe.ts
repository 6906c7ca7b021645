// Runs in the page before its scripts, and notes what reaches the main thread and when. The page itself is the one that
// users have. The function has everything that it needs inside: it is sent to the browser as text.

export interface Probe {
  // Telemetry, as the connection's worker delivers it.
  handling_ms: number; // of the page's own function for these messages
  samples: number;
  messages: number;
  bytes: number;
  frame_bytes: number; // of the last message with one row
  // Milliseconds from a key on a slider to the arrival of the first row with another set-point.
  changes: number[];
  // When a key was pressed on a slider, and Space: milliseconds since 1970.
  slider_keys: number[];
  stop_keys: number[];
  quiet_rows: number; // with the same set-points as the row before
  watches_setpoints: boolean;
  // Milliseconds from Space to the answer that all joints have stopped.
  stops: number[];
  long_tasks: number[]; // milliseconds
  usable: number | null; // milliseconds since the navigation began
  copies: number; // how often each message is delivered
  delivered_ticks: number;
}

declare global {
  interface Window {
    figures: Probe;
  }
}

export function installProbe(): void {
  const probe: Probe = {
    handling_ms: 0,
    samples: 0,
    messages: 0,
    bytes: 0,
    frame_bytes: 0,
    changes: [],
    slider_keys: [],
    stop_keys: [],
    quiet_rows: 0,
    watches_setpoints: false,
    stops: [],
    long_tasks: [],
    usable: null,
    copies: 1,
    delivered_ticks: 0,
  };
  window.figures = probe;

  let keyTime: number | null = null; // of a key whose effect has not arrived
  let stopTime: number | null = null;
  addEventListener(
    'keydown',
    (event) => {
      const time = performance.timeOrigin + event.timeStamp;
      if (event.key === ' ') {
        stopTime = event.timeStamp;
        probe.stop_keys.push(time);
      }
      if (event.target instanceof HTMLInputElement && event.target.type === 'range') {
        keyTime = event.timeStamp;
        probe.slider_keys.push(time);
      }
    },
    true,
  );

  const headerBytes = 16;
  let counts = new Map<string, number>(); // values of each signal
  let names: string[] = []; // the subscription
  let before: string | null = null; // set-points of the last row

  const noteSetpoints = (buffer: ArrayBuffer, rows: number, now: number) => {
    const width = names.reduce((total, name) => total + (counts.get(name) ?? 0), 0);
    const start = names.slice(0, names.indexOf('setpoint')).reduce((total, name) => total + (counts.get(name) ?? 0), 0);
    if (!names.includes('setpoint') || (buffer.byteLength - headerBytes) / 4 !== rows * width) {
      return; // of an earlier subscription
    }
    const values = new Int32Array(buffer, headerBytes);
    for (let row = 0; row < rows; row += 1) {
      const first = row * width + start;
      const setpoints = values.subarray(first, first + (counts.get('setpoint') ?? 0)).join();
      probe.quiet_rows = setpoints === before ? probe.quiet_rows + 1 : 0;
      if (probe.quiet_rows === 0 && keyTime !== null) {
        probe.changes.push(now - keyTime);
        keyTime = null;
      }
      before = setpoints;
    }
  };

  type Handler = (event: { data: any }) => void;
  let nextTick = -1; // of copies
  const deliverTelemetry = (buffer: ArrayBuffer, handler: Handler) => {
    const now = performance.now();
    const header = new DataView(buffer);
    const rows = header.getUint16(8, true);
    probe.messages += 1;
    probe.bytes += buffer.byteLength;
    probe.samples += (buffer.byteLength - headerBytes) / 4;
    if (rows === 1) probe.frame_bytes = buffer.byteLength;
    if (probe.watches_setpoints) noteSetpoints(buffer, rows, now);
    const ticks = rows * header.getUint16(10, true);
    if (nextTick < 0 || probe.copies === 1) nextTick = header.getUint32(4, true);
    const begin = performance.now();
    for (let copy = 0; copy < probe.copies; copy += 1) {
      const message = probe.copies === 1 ? buffer : buffer.slice(0);
      new DataView(message).setUint32(4, nextTick, true);
      handler({ data: { kind: 'telemetry', buffer: message } });
      nextTick += ticks;
      probe.delivered_ticks += ticks;
    }
    probe.handling_ms += performance.now() - begin;
  };

  const deliver = (data: any, handler: Handler) => {
    if (data.kind === 'telemetry') {
      deliverTelemetry(data.buffer, handler);
      return;
    }
    if (data.kind === 'message' && data.message.type === 'document' && data.message.name === 'telemetry') {
      counts = new Map(data.message.value.signals.map((signal: any) => [signal.name, signal.count]));
    }
    handler({ data });
    // An operation has one answer, a connection one greeting.
    const isRepeated = data.kind !== 'result' && data.kind !== 'status';
    for (let copy = 1; copy < probe.copies && isRepeated; copy += 1) {
      handler({ data: structuredClone(data) });
    }
  };

  const PlainWorker = window.Worker;
  window.Worker = class extends PlainWorker {
    private readonly isConnection: boolean;

    constructor(url: string | URL, options?: WorkerOptions) {
      super(url, options);
      this.isConnection = String(url).includes('connection_worker');
      if (this.isConnection) {
        const set = (handler: Handler) => this.addEventListener('message', (event) => deliver(event.data, handler));
        Object.defineProperty(this, 'onmessage', { set });
      }
    }

    override postMessage(message: any, options?: any): void {
      if (this.isConnection && message.kind === 'subscribe') {
        names = message.signals;
      }
      super.postMessage(message, options);
    }
  };

  const PlainSocket = window.WebSocket;
  window.WebSocket = class extends PlainSocket {
    constructor(url: string | URL) {
      super(url);
      this.addEventListener('message', (event) => {
        if (stopTime !== null && typeof event.data === 'string' && event.data.includes('"stopped"')) {
          probe.stops.push(performance.now() - stopTime);
          stopTime = null;
        }
      });
    }
  };

  new PerformanceObserver((list) => {
    for (const entry of list.getEntries()) probe.long_tasks.push(entry.duration);
  }).observe({ type: 'longtask', buffered: true });

  // Usable: control can be taken, the parameters and the 3D view are there.
  const needed = ['button.stop', '.control button', '[data-parameter] input[type=range]', '[data-testid=scene]', '[data-testid=joints] tbody tr'];
  new MutationObserver(() => {
    if (probe.usable === null && needed.every((selector) => document.querySelector(selector) !== null)) {
      probe.usable = performance.now();
    }
  }).observe(document, { subtree: true, childList: true, attributes: true });
}
