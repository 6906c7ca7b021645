// A server that says what a script says, with the messages of docs/page-interface.md: for what a robot on a simulated bus
// does not do at a test's word (a bus that breaks, modules with faults, another host).
import { readFileSync } from 'node:fs';
import { createServer, type Server } from 'node:http';
import type { AddressInfo } from 'node:net';
import type {
  BusDocument,
  BusModule,
  BusSession,
  ControlDocument,
  Documents,
  RobotDocument,
  Signal,
} from '../../../../../host/page/source/wire/messages.js';
import { noValue, protocol } from '../../../../../host/page/source/wire/messages.js';
import { encodeTelemetry } from '../../support/telemetry.js';
import { WebSocketPeer } from './web_socket_peer.js';

const joints = 5;
const pageFolder = 'build/page';
const period = 20; // milliseconds from one message of telemetry to the next: two ticks
const degreeScale = 1e-3;

const contentTypes: Record<string, string> = { html: 'text/html', js: 'text/javascript', css: 'text/css' };

// A straight chain of boxes along x, the head in front.
function chain(): RobotDocument {
  const lengthOf = 0.1;
  const x = (link: number) => -link * lengthOf;
  return {
    name: 'caterpillar',
    file: 'scripted.simulation.xml',
    kind: 'bus',
    joints: Array.from({ length: joints }, (_, j) => ({
      name: `J${j + 1}`,
      node: j + 1,
      lower: -90,
      upper: 90,
      anchor: [x(j) - lengthOf / 2, 0, 0.03],
      axis: [0, 1, 0],
    })),
    links: Array.from({ length: joints + 1 }, (_, i) => ({
      name: `link ${i + 1}`,
      pose: [x(i), 0, 0.03, 1, 0, 0, 0],
      shapes: [{ kind: 'box', pose: [0, 0, 0, 1, 0, 0, 0], size: [0.042, 0.03, 0.025] }],
    })),
    terrain: [],
    slots: [],
  };
}

const signals: Signal[] = [
  { name: 'setpoint', unit: 'degree', scale: degreeScale, count: joints, of: 'joint' },
  { name: 'angle', unit: 'degree', scale: degreeScale, count: joints, of: 'joint' },
  { name: 'current', unit: 'mA', scale: 1, count: joints, of: 'joint' },
  { name: 'simulated_angle', unit: 'degree', scale: degreeScale, count: joints, of: 'joint' },
  { name: 'contact', unit: '', scale: 1, count: joints + 1, of: 'link' },
  { name: 'head', unit: '', scale: 1, count: 7, of: 'robot' },
];

const confirmedByAll = { confirmed: joints, of: joints };

const initialBus = (): BusDocument => ({
  address: 'can0',
  connected: true,
  problem: null,
  load: 0.118,
  syncs: 100,
  other_host: false,
  latency_ms: 2.1,
  modules: Array.from({ length: joints }, (_, j) => moduleOf(j + 1, j)),
});

const initialSession = (): BusSession => ({
  kind: 'bus',
  state: 'held',
  run: 1,
  tick: 0,
  time_s: 0,
  stopped_by: null,
  recording: null,
  changed: false,
  undo: null,
  redo: null,
  failure: null,
  gait: { compared: 5000, differences: 0, missing: 2, first_difference: null, end: null },
  started_with: 'power',
});

interface Viewer {
  peer: WebSocketPeer;
  client: number;
  subscriptions: number;
  names: string[];
}

export class ScriptedRobot {
  // What the script may change; `publish` sends it.
  readonly bus = initialBus();
  readonly session = initialSession();
  isSilent = false; // sends nothing but the answer to a greeting
  unmeasured: number | null = null; // a joint that does not measure its angle
  // Arguments of `pose`, and when they came, in milliseconds.
  readonly poses: { time: number; angles: (number | null)[]; speed: number }[] = [];
  stopAnswer = confirmedByAll;
  readonly setpoints = new Array<number>(joints).fill(0); // degrees
  private readonly control: ControlDocument = { epoch: 0, holder: null, away: false, request: null };
  private readonly peers: WebSocketPeer[] = []; // also those that are only for STOP
  private viewers: Viewer[] = [];
  private clients = 0;
  private revision = 0;
  private tick = 0;
  private readonly timer: ReturnType<typeof setInterval>;

  private constructor(private readonly server: Server) {
    this.timer = setInterval(() => this.sendTelemetry(), period);
  }

  static async start(): Promise<ScriptedRobot> {
    const server = createServer((request, response) => {
      const name = request.url === '/' ? 'index.html' : (request.url ?? '').slice(1);
      if (request.method === 'POST') {
        response.end('{"stopped": true}');
        return;
      }
      try {
        const bytes = readFileSync(`${pageFolder}/${name.replace(/[^\w.-]/g, '')}`);
        response.setHeader('Content-Type', contentTypes[name.split('.').at(-1) ?? ''] ?? 'application/octet-stream');
        response.end(bytes);
      } catch {
        response.statusCode = 404;
        response.end();
      }
    });
    const robot = new ScriptedRobot(server);
    server.on('upgrade', (request, stream) => robot.accept(new WebSocketPeer(request, stream)));
    await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve));
    return robot;
  }

  get address(): string {
    return `http://127.0.0.1:${(this.server.address() as AddressInfo).port}/#token`;
  }

  // As at the start, but who has control keeps it.
  reset(): void {
    Object.assign(this.bus, initialBus());
    Object.assign(this.session, initialSession(), { run: this.session.run + 1 });
    Object.assign(this, { isSilent: false, unmeasured: null, stopAnswer: confirmedByAll });
    this.poses.length = 0;
    this.setpoints.fill(0);
    this.publish();
  }

  publish(): void {
    this.viewers.forEach((viewer) => this.sendDocuments(viewer));
  }

  async end(): Promise<void> {
    clearInterval(this.timer);
    this.peers.forEach((peer) => peer.end());
    this.server.closeAllConnections();
    await new Promise((resolve) => this.server.close(resolve));
  }

  private accept(peer: WebSocketPeer): void {
    this.peers.push(peer);
    const viewer: Viewer = { peer, client: ++this.clients, subscriptions: 0, names: [] };
    peer.onText = (text) => this.receive(viewer, JSON.parse(text) as Record<string, unknown>);
  }

  private receive(viewer: Viewer, message: Record<string, unknown>): void {
    const answer = (fields: object) => this.sendTo(viewer, fields);
    switch (message['type']) {
      case 'hello':
        // Also while it is silent: a page that reconnects would wait for it forever.
        viewer.peer.sendText(JSON.stringify({ type: 'welcome', protocol, client: viewer.client, program: 'script', next_notice: 0 }));
        if (message['only'] !== 'stop') {
          this.viewers.push(viewer);
          this.sendDocuments(viewer);
        }
        return;
      case 'stop':
        Object.assign(this.session, { state: 'off', stopped_by: 'STOP', run: this.session.run + 1 });
        this.publish();
        return answer({ type: 'stopped', ms: 12, ...this.stopAnswer });
      case 'subscribe':
        viewer.subscriptions += 1;
        viewer.names = message['signals'] as string[];
        return;
      case 'operation':
        this.operate(viewer, message['name'] as string, message['arguments'] as Record<string, unknown>);
        return answer({ type: 'result', id: message['id'], ok: true, value: { epoch: this.control.epoch } });
    }
  }

  private operate(viewer: Viewer, name: string, parameters: Record<string, unknown>): void {
    if (name === 'control.take') {
      Object.assign(this.control, { epoch: this.control.epoch + 1, holder: { client: viewer.client, name: 'viewer' } });
    } else if (name === 'pose') {
      const angles = parameters['angles'] as (number | null)[];
      this.poses.push({ time: performance.now(), angles, speed: parameters['speed'] as number });
      angles.forEach((angle, joint) => (this.setpoints[joint] = angle ?? (this.setpoints[joint] as number)));
    } else if (name === 'power') {
      this.session.state = parameters['on'] === true ? 'held' : 'off';
      this.session.run += 1;
    } else if (name === 'run' || name === 'pause') {
      this.session.state = name === 'run' ? 'running' : 'held';
    }
    if (name !== 'ping' && name !== 'pose') {
      this.publish();
    }
  }

  private sendTo({ peer }: Viewer, message: object): void {
    if (!this.isSilent) peer.sendText(JSON.stringify(message));
  }

  private sendDocuments(viewer: Viewer): void {
    type OfMake = 'draft' | 'draft_robot' | 'draft_meshes' | 'library' | 'parts' | Extract<keyof Documents, `algorithm${string}` | `search${string}` | 'sweeps'> | 'missing_algorithms' | 'foresight' | 'gallery' | 'modules' | 'module_job' | 'class' | 'seat' | 'handed_out' | 'program';
    const documents: Omit<Documents, 'remote_values' | OfMake> = {
      robot: chain(),
      parameters: [],
      session: this.session,
      bus: this.bus,
      control: this.control,
      telemetry: { hash: 1, tick_us: 10000, signals },
      recordings: { folder: 'runs', open: null, alone: false },
      remote: { devices: [], bindings: [], problems: [], learning: false, active: false, file: null, saved: true },
    };
    for (const [name, value] of Object.entries(documents)) {
      // A new revision of these ends the subscription, or loads the robot anew.
      const isConstant = name === 'telemetry' || name === 'robot';
      if (isConstant && viewer.subscriptions > 0) continue;
      this.sendTo(viewer, { type: 'document', name, revision: ++this.revision, value });
    }
  }

  private valuesOf(name: string): number[] {
    const wave = (joint: number) =>
      this.session.state === 'running' ? 40 * Math.sin(this.tick / 30 - joint) : (this.setpoints[joint] as number);
    const angles = (offset: number) => Array.from({ length: joints }, (_, j) => Math.round((wave(j) + offset) / degreeScale));
    switch (name) {
      case 'setpoint':
        return angles(0);
      case 'angle':
        return angles(-2).map((raw, j) => (j === this.unmeasured || !this.bus.connected ? noValue : raw));
      case 'simulated_angle':
        return angles(-12);
      case 'current':
        return new Array<number>(joints).fill(320);
      case 'contact':
        return new Array<number>(joints + 1).fill(3);
      default:
        return [0, 0, 40000, 2 ** 30, 0, 0, 0];
    }
  }

  private sendTelemetry(): void {
    this.tick += 2;
    for (const { peer, names, subscriptions } of this.viewers) {
      if (this.isSilent || names.length === 0) continue;
      const rows = [0, 1].map(() => names.flatMap((name) => this.valuesOf(name)));
      peer.sendBinary(encodeTelemetry({ subscription: subscriptions, tick: this.tick - 1, run: this.session.run, rows }));
    }
  }
}

export function moduleOf(node: number, joint: number | null): BusModule {
  return {
    node,
    joint,
    state: 'Operational',
    drive: 'operation enabled',
    angle: 12.5,
    current: 320,
    current_limit: 2000,
    temperature: 31,
    fault: null,
    advice: null,
    silent: false,
    stop_confirmed: null,
  };
}
