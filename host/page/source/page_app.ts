// Creates the stores of the page and connects them: state, connection, STOP, data.
import { computed, effect, signal } from '@preact/signals-core';
import { TelemetryHistory } from './data/telemetry_history.js';
import type { PageName, PageStores } from './view/robot_view.js';
import { ActionList } from './state/actions.js';
import { MoveTool } from './state/move_tool.js';
import { OperationQueue } from './state/operations.js';
import { PageState } from './state/page_state.js';
import { PoseQueue } from './state/pose_queue.js';
import { SetQueue } from './state/set_queue.js';
import { SignalSelection } from './state/signal_selection.js';
import { StopControl } from './state/stop_report.js';
import { TimeMarks } from './state/time_marks.js';
import { TimeView } from './state/time_view.js';
import { openStopChannel } from './wire/open_stop_channel.js';
import type { PageAddress } from './wire/page_address.js';
import type { FromConnectionWorker, ToConnectionWorker } from './wire/connection_worker.js';
import { decodeTelemetry } from './wire/telemetry_message.js';
import { Subscriptions } from './wire/subscription.js';

const freshnessPeriod = 500; // milliseconds

export class PageApp implements PageStores {
  readonly state = new PageState();
  readonly history = new TelemetryHistory();
  readonly time = new TimeView();
  readonly marks = new TimeMarks(this.time);
  readonly selection = new SignalSelection();
  readonly actions = new ActionList();
  readonly wholePath = signal(null);
  // The page that is shown, and the actions of the recording on the page Recordings.
  readonly shownPage = signal<PageName>('live');
  readonly recordingActions = signal<ActionList | null>(null);
  readonly makeActions = signal<ActionList | null>(null);
  readonly modulesActions = signal<ActionList | null>(null);
  readonly wantedScenario = signal<string | null>(null);
  readonly operations: OperationQueue;
  readonly sets: SetQueue;
  readonly mover: MoveTool;
  readonly poses: PoseQueue;
  readonly stop: StopControl;
  private readonly worker = new Worker('connection_worker.js');
  private subscriptions = new Subscriptions();
  private sessionRun: number | null = null; // run in the last document
  // Gestures of two viewers must not have the same number, or undo would treat them as one.
  private lastGesture = Math.floor(Math.random() * 2 ** 20) * 1024;

  constructor(address: PageAddress, token: string, name: string) {
    this.operations = new OperationQueue(this.state, (request) => this.post({ kind: 'operation', request }));
    this.sets = new SetQueue({
      send: (words, gesture) => this.operations.ask('set', { words, gesture }),
      reset: (names) => this.operations.ask('reset', { names }),
      refused: (reason) => this.state.addNotice('warning', reason),
    });
    this.mover = new MoveTool(this.state, (place) => this.operations.tell('move', { ...place }));
    this.poses = new PoseQueue({
      isPossible: () => this.state.obstacleTo('pose') === null,
      send: (angles, speed) => this.operations.ask('pose', { angles, speed }),
      refused: (reason) => this.state.addNotice('warning', reason),
      after: (ms, action) => void setTimeout(action, ms),
    });
    this.stop = new StopControl(openStopChannel(address, token, name));
    this.worker.onmessage = (event: MessageEvent<FromConnectionWorker>) => this.receive(event.data);
    this.post({ kind: 'open', url: address.socket, token, name, wantsControl: !address.onlyLooks });
    effect(() => this.subscribe());
    effect(() => this.noteRun(this.state.session.value?.run));
    // Without a robot there are recordings, or the scenario of the start needs an algorithm, which the page Make builds.
    const needsAlgorithm = computed(() => this.state.missingAlgorithms.value?.action === 'start');
    effect(() => {
      if (needsAlgorithm.value) this.shownPage.value = 'make';
    });
    effect(() => {
      if (this.state.isAlone.value && this.shownPage.peek() !== 'modules') this.shownPage.value = needsAlgorithm.peek() ? 'make' : 'recordings';
    });
    effect(() => {
      if (!this.poses.isPossible) this.poses.forget();
    });
    // A robot that moves again is not stopped.
    const moves = computed(() => /^(running|starting)$/.test(this.state.session.value?.state ?? ''));
    effect(() => {
      if (moves.value) this.stop.clear();
    });
    setInterval(() => this.state.freshness.check(performance.now()), freshnessPeriod);
  }

  startSceneWorker(): Worker {
    return new Worker('scene_worker.js');
  }

  // The actions of the page that is shown, which keys and the palette find.
  get shownActions(): ActionList {
    const own = { live: null, recordings: this.recordingActions.value, make: this.makeActions.value, modules: this.modulesActions.value };
    return own[this.shownPage.value] ?? this.actions;
  }

  newGesture(): number {
    this.lastGesture += 1;
    return this.lastGesture;
  }

  // For a live robot, one history has every row.
  get sampledRows(): TelemetryHistory {
    return this.history;
  }

  get rowsAtCursor(): TelemetryHistory {
    return this.history;
  }

  // The number of ticks in a second.
  get tickRate(): number {
    return 1e6 / (this.state.telemetry.value?.tick_us ?? 10000);
  }

  // The newest tick that is known; 0 before the first.
  get newestTick(): number {
    return this.history.end === 0 ? (this.state.session.peek()?.tick ?? 0) : this.history.lastTick();
  }

  private post(message: ToConnectionWorker): void {
    this.worker.postMessage(message);
  }

  private subscribe(): void {
    if (!this.state.isConnected.value) {
      this.subscriptions = new Subscriptions();
      return;
    }
    const telemetry = this.state.telemetry.value;
    if (telemetry !== null) {
      const names = this.subscriptions.select(telemetry, this.selection.needed(telemetry.signals));
      if (names !== null) {
        // A robot that stands still sends no further row.
        this.post({ kind: 'subscribe', signals: names, hash: telemetry.hash, newest: this.history.end === 0 });
      }
    }
  }

  // Clears the history after a restart while the robot is paused, because the first tick may come much later.
  private noteRun(run: number | undefined): void {
    if (run !== undefined && this.sessionRun !== null && run !== this.sessionRun) {
      this.state.forgetProblems();
    }
    if (run !== undefined && this.sessionRun !== null && run !== this.sessionRun && run !== this.history.run) {
      this.history.clear();
      this.time.goLive();
      this.marks.clear();
    }
    this.sessionRun = run ?? null;
  }

  private receive(message: FromConnectionWorker): void {
    switch (message.kind) {
      case 'alive?':
        return this.post({ kind: 'alive' });
      case 'status':
        return this.state.receiveStatus(message.status);
      case 'message':
        return this.state.receive(message.message);
      case 'result':
        return this.operations.receive(message.key, message.result);
      case 'latency':
        this.state.latency.value = message.ms;
        return;
      case 'telemetry':
        return this.receiveTelemetry(message.buffer);
    }
  }

  private receiveTelemetry(buffer: ArrayBuffer): void {
    const telemetry = decodeTelemetry(buffer);
    const layout = this.subscriptions.layoutOf(telemetry.subscription);
    if (layout === null) {
      return;
    }
    if (telemetry.run !== this.history.run) {
      this.time.goLive();
      this.marks.clear();
    }
    this.history.append(telemetry, layout);
    // Without the bus the rows continue, but contain nothing about the robot.
    if (this.state.bus.peek()?.connected !== false) {
      this.state.freshness.note(performance.now());
    }
  }
}
