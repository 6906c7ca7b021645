// The stores of the page Modules: the rows of its table, what is chosen, and the job that goes on.
import { computed, effect, signal, untracked } from '@preact/signals-core';
import { ActionList } from '../state/actions.js';
import type { Stores } from '../view/robot_view.js';
import type { JobKind, ModuleJob, ModuleOperations } from '../wire/messages.js';
import { advanceWith, type KnownAdvance } from './flash_rows.js';
import { isRunning, jobTitle } from './job_text.js';
import { moduleRows, nodeList } from './module_rows.js';
import { ModuleObjects } from './module_objects.js';
import { PlaceAnswers } from './place_answers.js';
import { QuestionAnswers } from './question_answers.js';
import { touchSeen, type TouchWatch } from './touch_watch.js';

export type ModulesStores = Stores<'actions' | 'modulesActions' | 'operations' | 'shownPage' | 'startSceneWorker' | 'state'>;

export const taskNames = ['module', 'places', 'flash', 'recover', 'settings', 'doctor'] as const;
export type TaskName = (typeof taskNames)[number];

const taskOfKind: Partial<Record<string, TaskName>> = {
  examine: 'doctor',
  save: 'settings',
  compare: 'settings',
  load: 'settings',
  assign: 'places',
  calibrate: 'module',
  flash: 'flash',
  recover: 'recover',
};

// Jobs during which the program does not ask the modules for their sensors.
const keepsBus: readonly JobKind[] = ['assign', 'calibrate', 'flash', 'recover'];
const settlingTime = 4000; // milliseconds

export class ModulesApp {
  readonly task = signal<TaskName>('module');
  readonly chosenNode = signal<number | null>(null);
  readonly checkedNodes = signal<ReadonlySet<number>>(new Set());
  readonly seenTouch = signal<ReadonlyMap<number, TouchWatch>>(new Map()); // by node ids
  readonly flashAdvance = signal<KnownAdvance | null>(null);
  private readonly earlierJobs = signal<ReadonlyMap<JobKind, ModuleJob>>(new Map()); // the last one of each kind on this bus
  readonly modules = computed(() => this.page.state.modules.value);
  readonly job = computed(() => this.page.state.moduleJob.value);
  readonly isOpen = computed(() => (this.modules.value?.bus ?? null) !== null);
  readonly bus = computed(() => (this.isOpen.value ? this.page.state.bus.value : null));
  readonly rows = computed(() => {
    const modules = this.modules.value;
    const job = this.job.value;
    const watch = { knowsSilence: this.isWatched.value, readsTouch: job === null || !isRunning(job) || !keepsBus.includes(job.kind) };
    return modules === null || !this.isOpen.value ? [] : moduleRows(this.bus.value?.modules ?? [], modules, watch);
  });
  readonly chosenRow = computed(() => this.rows.value.find(({ node }) => node === this.chosenNode.value) ?? null);
  // The checked rows that are still there; null: none.
  readonly checkedList = computed(() => {
    const nodes = this.rows.value.map(({ node }) => node).filter((node) => this.checkedNodes.value.has(node));
    return nodes.length === 0 ? null : nodeList(nodes);
  });
  readonly objects: ModuleObjects;
  readonly answers: QuestionAnswers;
  readonly places: PlaceAnswers;
  readonly actions: ActionList;
  private readonly isWatched = signal(true); // false during a job, and until the modules can have been asked again
  readonly revealed = signal(0); // counts when the task must come into view
  private scannedBus: string | null = null;
  private readonly firstScan = signal(0); // the job that scans a bus that was just opened; Infinity: it is requested

  constructor(readonly page: ModulesStores) {
    this.actions = new ActionList(page.actions, ({ group }) => group === 'Page' || group === 'Robot');
    this.objects = new ModuleObjects(page.operations, this.chosenNode);
    this.answers = new QuestionAnswers(this);
    this.places = new PlaceAnswers(this);
    page.modulesActions.value = this.actions;
    this.followJob();
    effect(() => this.scanNewBus());
    effect(() => {
      // What the chosen module has, as soon as it can be read.
      const node = this.chosenNode.value;
      const canRead = node !== null && this.readObstacle.value === null;
      if (canRead && this.task.value === 'module') untracked(() => void this.objects.readIfNew());
    });
    effect(() => {
      if (page.shownPage.value === 'modules' && page.state.isConnected.value) untracked(() => void page.operations.ask('modules.look', {}).catch(() => {}));
    });
    effect(() => this.noteTouch());
    this.watchAfterJobs();
  }

  // The reason why objects cannot be read now; null: they can.
  readonly readObstacle = computed(() => this.obstacle(false));

  // The reason why no job can begin; null: one can. `needsControl`: only for who drives.
  obstacle(needsControl = true): string | null {
    const { state } = this.page;
    const job = this.job.value;
    if (!state.isConnected.value) return 'No connection to the program.';
    if (needsControl && !state.isHolder.value) return 'Take control first (C).';
    if (!this.isOpen.value) return 'Open a bus first.';
    if (this.bus.value?.connected !== true) return 'No connection to the bus.';
    const session = state.busSession.value;
    if (session !== null && session.state !== 'off' && session.state !== 'failed') return 'The servos have power: Power off first, on the page Live.';
    if (this.firstScan.value > (job?.number ?? 0)) return 'Wait until “Scan” has ended.';
    return job !== null && isRunning(job) ? `Wait until “${jobTitle(job.kind)}” has ended, or cancel it.` : null;
  }

  // The reason why a running job cannot be answered or cancelled; null: it can.
  answerObstacle(): string | null {
    if (!this.page.state.isConnected.value) return 'No connection to the program.';
    return this.page.state.isHolder.value ? null : 'Take control first (C).';
  }

  // The last job of this kind that this page knows.
  lastOf(kind: JobKind): ModuleJob | null {
    const job = this.job.value;
    return job?.kind === kind ? job : (this.earlierJobs.value.get(kind) ?? null);
  }

  choose(node: number | null): void {
    this.chosenNode.value = node;
    if (node !== null) this.task.value = 'module';
  }

  // Shows a task, where it can be seen.
  show(task: TaskName): void {
    this.task.value = task;
    this.revealed.value += 1;
  }

  check(node: number, isOn: boolean): void {
    const nodes = new Set(this.checkedNodes.peek());
    if (isOn) nodes.add(node);
    else nodes.delete(node);
    this.checkedNodes.value = nodes;
  }

  // Begins a job, or opens or closes the bus. A refusal becomes a notice; returns whether it was done.
  async tell<Name extends keyof ModuleOperations>(name: Name, parameters: ModuleOperations[Name]): Promise<boolean> {
    return (await this.page.operations.tell(name, parameters as never)) !== null;
  }

  cancel(): void {
    const job = this.job.peek();
    if (job !== null) void this.tell('modules.cancel', { job: job.number });
  }

  // Answers the question of the running job. Returns whether the program has taken it.
  async sendAnswer(word: string): Promise<boolean> {
    const job = this.job.peek();
    if (job === null || job.question === null) return false;
    return this.tell('modules.answer', { job: job.number, question: job.question.number, word });
  }

  // A page that is opened, or reloaded, in the middle of a job shows where that is.
  private followJob(): void {
    let shown: number | null = null;
    effect(() => {
      const job = this.job.value;
      if (job === null) return;
      untracked(() => (this.earlierJobs.value = new Map([...this.earlierJobs.peek(), [job.kind, job]])));
      if (job.kind === 'flash' || job.kind === 'recover') untracked(() => (this.flashAdvance.value = advanceWith(this.flashAdvance.peek(), job)));
      if (job.number === shown) return;
      shown = job.number;
      const task = taskOfKind[job.kind];
      if (task !== undefined && isRunning(job)) untracked(() => this.show(task));
    });
  }

  // A bus that was just opened is scanned once, by the page of who drives, or by any if nobody does.
  private scanNewBus(): void {
    const modules = this.modules.value;
    const isShown = this.page.shownPage.value === 'modules';
    // Another program counts its jobs anew.
    if (!this.page.state.isConnected.value) this.forgetFirstScan();
    if (modules === null || modules.bus === null) {
      this.forgetFirstScan();
      this.earlierJobs.value = new Map();
      return;
    }
    if (!isShown || modules.found !== null || this.scannedBus === modules.bus || this.readObstacle.value !== null) return;
    if (this.page.state.otherHolder.value !== null) return;
    this.scannedBus = modules.bus;
    untracked(() => void this.beginFirstScan(modules.bus));
  }

  private forgetFirstScan(): void {
    this.scannedBus = null;
    this.firstScan.value = 0;
  }

  // No other job can begin before it: who has just opened the bus sees why.
  private async beginFirstScan(bus: string | null): Promise<void> {
    this.firstScan.value = Infinity;
    let job = 0;
    try {
      ({ job } = (await this.page.operations.ask('modules.scan', {})) as { job: number });
    } catch {
      // Another viewer's job goes on.
    }
    if (this.scannedBus === bus) this.firstScan.value = job; // the bus has not been closed meanwhile
  }

  private watchAfterJobs(): void {
    const goesOn = computed(() => isRunning(this.job.value));
    effect(() => {
      if (goesOn.value) {
        this.isWatched.value = false;
        return undefined;
      }
      const timer = setTimeout(() => (this.isWatched.value = true), settlingTime);
      return () => clearTimeout(timer);
    });
  }

  private noteTouch(): void {
    const row = this.chosenRow.value;
    if (row === null || row.touch === null || row.live?.silent === true) return;
    const { node, touch } = row;
    untracked(() => (this.seenTouch.value = new Map([...this.seenTouch.peek(), [node, touchSeen(this.seenTouch.peek().get(node) ?? null, touch)]])));
  }

  forgetTouch(node: number): void {
    const seen = new Map(this.seenTouch.peek());
    seen.delete(node);
    this.seenTouch.value = seen;
    this.noteTouch();
  }
}
