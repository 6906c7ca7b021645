// The knowledge of the page about the robot and its program: the last documents, the connection, the notices.
import { computed, signal } from '@preact/signals-core';
import type { ConnectionStatus } from '../wire/connection.js';
import { Freshness } from './freshness.js';
import type {
  AlgorithmBuild,
  AlgorithmCheck,
  AlgorithmFolders,
  AlgorithmImage,
  BusDocument,
  Documents,
  DraftDocument,
  ForesightDocument,
  HandedOut,
  AlgorithmDocument,
  LibraryItem,
  MissingAlgorithms,
  PartsDocument,
  ProgramDocument,
  Mesh,
  ModuleJob,
  ModulesDocument,
  ControlDocument,
  InternalValue,
  NoticeMessage,
  Parameter,
  RemoteDocument,
  RemoteValues,
  RecordingsDocument,
  RobotDocument,
  SearchesDocument,
  SearchMethodsDocument,
  SweepsDocument,
  SeatDocument,
  ServerMessage,
  SessionDocument,
  TelemetryDocument,
} from '../wire/messages.js';
import { obstacleTo, type RobotCommand } from './robot_commands.js';

export interface Notice {
  number: number; // ascending
  level: NoticeMessage['level'];
  text: string;
  isForAll: boolean; // about the live robot, not only for this viewer
}

const keptNotices = 200;

// Unchanged entries stay the same objects, because drawing all of 60 joints again delays a slider by 7 ms.
function reuse<T>(before: readonly T[], after: readonly T[]): readonly T[] {
  return after.map((value, i) => {
    const known = before[i];
    return known !== undefined && JSON.stringify(known) === JSON.stringify(value) ? known : value;
  });
}

export class PageState {
  readonly connection = signal<ConnectionStatus>({ state: 'connecting' });
  readonly latency = signal<number | null>(null); // milliseconds to the session and back
  readonly robot = signal<RobotDocument | null>(null);
  readonly parameters = signal<readonly Parameter[]>([]);
  readonly internalValues = signal<readonly InternalValue[]>([]);
  readonly session = signal<SessionDocument | null>(null);
  readonly bus = signal<BusDocument | null>(null);
  readonly control = signal<ControlDocument | null>(null);
  readonly telemetry = signal<TelemetryDocument | null>(null);
  readonly remote = signal<RemoteDocument | null>(null);
  readonly remoteValues = signal<RemoteValues | null>(null);
  readonly recordings = signal<RecordingsDocument | null>(null);
  // The scenario that viewers make.
  readonly draft = signal<DraftDocument | null>(null);
  readonly draftRobot = signal<RobotDocument | null>(null);
  readonly draftMeshes = signal<readonly Mesh[]>([]);
  readonly library = signal<readonly LibraryItem[]>([]);
  readonly parts = signal<PartsDocument | null>(null);
  readonly algorithms = signal<readonly AlgorithmDocument[]>([]);
  readonly foresight = signal<ForesightDocument | null>(null);
  // The first seconds of a newer path that is not known to its end yet.
  readonly foresightStart = signal<ForesightDocument['path']>([]);
  // What can be opened; null until somebody has looked.
  readonly gallery = signal<Documents['gallery'] | null>(null);
  // Algorithms that viewers write.
  readonly algorithmFolders = signal<AlgorithmFolders | null>(null);
  readonly algorithmBuild = signal<AlgorithmBuild | null>(null);
  readonly algorithmCheck = signal<AlgorithmCheck | null>(null);
  readonly algorithmImage = signal<AlgorithmImage | null>(null);
  readonly missingAlgorithms = signal<MissingAlgorithms | null>(null);
  // Searches for a gait; null until somebody has looked.
  readonly searches = signal<SearchesDocument | null>(null);
  readonly searchMethods = signal<SearchMethodsDocument | null>(null);
  readonly sweeps = signal<SweepsDocument | null>(null);
  // Modules on a bus, and the last job with them.
  readonly modules = signal<ModulesDocument | null>(null);
  readonly moduleJob = signal<ModuleJob | null>(null);
  // In a class: whose robot this is, and what the teacher has handed out.
  readonly seat = signal<SeatDocument | null>(null);
  readonly handedOut = signal<readonly HandedOut[]>([]);
  // The installation of the program; null until it has said it.
  readonly program = signal<ProgramDocument | null>(null);
  // Whether the program is another one than that with which this page began: the page may be too old for it.
  readonly isOtherProgram = signal(false);
  readonly freshness = new Freshness();
  readonly notices = signal<readonly Notice[]>([]);

  readonly client = computed(() => {
    const connection = this.connection.value;
    return connection.state === 'open' ? connection.client : null;
  });
  readonly isConnected = computed(() => this.client.value !== null);
  // The session of a simulated robot, or of one on a bus; the other one is null.
  readonly simulation = computed(() => {
    const session = this.session.value;
    return session === null || session.kind === 'bus' ? null : session;
  });
  readonly busSession = computed(() => {
    const session = this.session.value;
    return session?.kind === 'bus' ? session : null;
  });
  // Whether there are only recordings, and no robot until one of them is continued.
  readonly isAlone = computed(() => this.recordings.value?.alone === true && this.robot.value === null);
  // Whether there is a scenario to change, or one can be opened.
  readonly hasMake = computed(() => this.draft.value !== null || this.recordings.value?.alone === true);
  // Whether the page Modules is there; in a class it is for the teacher.
  readonly hasModules = computed(() => this.modules.value !== null && this.seat.value?.has_modules !== false);
  // Whether this viewer drives.
  readonly isHolder = computed(
    () => this.client.value !== null && this.control.value?.holder?.client === this.client.value,
  );
  // Whether this viewer does not drive. False as long as the program has not said who does.
  readonly isLookingOn = computed(() => this.isConnected.value && this.control.value !== null && !this.isHolder.value);
  // The name of another viewer who drives, else null.
  readonly otherHolder = computed(() => (this.isHolder.value ? null : (this.control.value?.holder?.name ?? null)));

  private firstProgram: string | null = null;
  private lastNotice = 0;
  private firstNews = 0; // number of the server's first notice that is shown
  private nextNotice: number | null = null; // number that its next notice has

  // The reason why a robot on a bus cannot do this now; null: it can.
  obstacleTo(command: RobotCommand): string | null {
    return obstacleTo(command, {
      isConnected: this.isConnected.value,
      isHolder: this.isHolder.value,
      session: this.busSession.value,
      bus: this.bus.value,
    });
  }

  receive(message: ServerMessage): void {
    if (message.type === 'notice') {
      this.receiveNotice(message);
    } else if (message.type === 'document') {
      switch (message.name) {
        case 'program':
          this.program.value = message.value;
          break;
        case 'robot':
          this.robot.value = message.value;
          break;
        case 'parameters':
          this.parameters.value = reuse(
            this.parameters.peek(),
            message.value.filter((value): value is Parameter => !value.internal),
          );
          this.internalValues.value = reuse(
            this.internalValues.peek(),
            message.value.filter((value): value is InternalValue => value.internal),
          );
          break;
        case 'session':
          this.session.value = message.value;
          break;
        case 'bus':
          this.bus.value = message.value;
          break;
        case 'control':
          this.control.value = message.value;
          break;
        case 'telemetry':
          this.telemetry.value = message.value;
          break;
        case 'remote':
          this.remote.value = message.value;
          break;
        case 'remote_values':
          this.remoteValues.value = message.value;
          break;
        case 'recordings':
          this.recordings.value = message.value;
          break;
        case 'draft':
          this.draft.value = message.value;
          break;
        case 'draft_robot':
          this.draftRobot.value = message.value;
          break;
        case 'draft_meshes':
          this.draftMeshes.value = message.value;
          break;
        case 'library':
          this.library.value = message.value;
          break;
        case 'parts':
          this.parts.value = message.value;
          break;
        case 'gallery':
          this.gallery.value = { entries: [...reuse(this.gallery.peek()?.entries ?? [], message.value.entries)] };
          break;
        case 'foresight':
          if (message.value.is_complete) this.foresight.value = message.value;
          this.foresightStart.value = message.value.is_complete ? [] : message.value.path;
          break;
        case 'algorithms':
          this.algorithms.value = message.value;
          break;
        case 'algorithm_folders':
          this.algorithmFolders.value = message.value;
          break;
        case 'algorithm_build':
          this.algorithmBuild.value = message.value;
          break;
        case 'algorithm_check':
          this.algorithmCheck.value = message.value;
          break;
        case 'algorithm_image':
          this.algorithmImage.value = message.value;
          break;
        case 'missing_algorithms':
          this.missingAlgorithms.value = message.value;
          break;
        case 'searches':
          this.searches.value = message.value;
          break;
        case 'search_methods':
          this.searchMethods.value = message.value;
          break;
        case 'sweeps':
          this.sweeps.value = message.value;
          break;
        case 'modules':
          this.modules.value = message.value;
          break;
        case 'module_job':
          this.moduleJob.value = message.value;
          break;
        case 'seat':
          this.seat.value = message.value;
          break;
        case 'handed_out':
          this.handedOut.value = message.value;
          break;
      }
    }
  }

  receiveStatus(status: ConnectionStatus): void {
    this.connection.value = status;
    if (status.state === 'open') {
      this.firstProgram ??= status.program;
      this.isOtherProgram.value = status.program !== this.firstProgram;
      // The server sends all its notices after each welcome: those that this page has missed are news.
      const isSameServer = this.nextNotice !== null && this.nextNotice <= status.nextNotice;
      this.firstNews = isSameServer ? (this.nextNotice ?? 0) : status.nextNotice;
      this.nextNotice = status.nextNotice;
    } else {
      this.latency.value = null;
      this.control.value = null;
    }
  }

  private receiveNotice({ number, level, text }: NoticeMessage): void {
    if (number !== undefined) {
      if (number < this.firstNews) return;
      this.nextNotice = number + 1;
    }
    this.append(level, text, number !== undefined);
  }

  // For a new run: warnings and errors are about the one before. (What else there is goes away by itself.)
  forgetProblems(): void {
    this.notices.value = this.notices.value.filter((notice) => notice.level === 'info');
  }

  // The notices that belong to what is in front: those about the live robot wait until it is seen again, except errors.
  noticesFor(isLiveInFront: boolean): readonly Notice[] {
    return this.notices.value.filter((notice) => isLiveInFront || !notice.isForAll || notice.level === 'error');
  }

  addNotice(level: Notice['level'], text: string): void {
    this.append(level, text, false);
  }

  private append(level: Notice['level'], text: string, isForAll: boolean): void {
    this.lastNotice += 1;
    this.notices.value = [...this.notices.value, { number: this.lastNotice, level, text, isForAll }].slice(-keptNotices);
  }
}
