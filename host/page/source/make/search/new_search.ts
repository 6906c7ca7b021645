// The form of a new search. It stays when another part is shown, and its experiment for the next search.
import { computed, effect, signal, untracked } from '@preact/signals-core';
import type { Experiment, Operations, SearchCheck, SearchEngine, SearchEstimate } from '../../wire/messages.js';
import { fieldProblem, type FieldProblem } from '../fields/field_problem.js';
import { fitToDraft, newExperiment, newObjective } from './experiment_defaults.js';
import { freeName, plainExperiment, proposedName } from './experiment_text.js';
import { NewestAnswer } from './newest_answer.js';
import type { SearchHost } from './search_host.js';
import { durationKey, evaluationsIn, timePresets, withEvaluations, type TimePreset } from './time_presets.js';

const checkDelay = 250; // milliseconds after the last change

export type EngineChoice = 'best' | 'own'; // best: the reduced one, if it has such a scenario; own: that of the scenario

type GoodCheck = Exclude<SearchCheck, { problem: object }>;

interface Measured {
  key: string;
  evaluation_s: number;
}

export class NewSearch {
  readonly isOpen = signal(false);
  readonly experiment = signal<Experiment | null>(null);
  readonly engine = signal<EngineChoice>('best');
  readonly workers = signal<number | null>(null); // null: all processors
  readonly typedName = signal<string | null>(null); // null: the proposed one
  readonly preset = signal<TimePreset | null>('half_minute'); // null: the evaluations were typed
  readonly checks: NewestAnswer<Experiment, SearchCheck>;
  readonly isStarting = signal(false);
  readonly isMeasuring = signal(false);
  readonly measured = signal<Measured | null>(null);
  private readonly startProblem = signal<FieldProblem | null>(null);
  private readonly failedKey = signal<string | null>(null); // of an estimate that was refused
  private measuring: Promise<void> = Promise.resolve();

  // What was found of the experiment as it is; null: it is wrong, or not known yet.
  readonly check = computed(() => {
    const answer = this.checks.last.value?.answer;
    return answer === undefined || answer.problem !== undefined ? null : answer;
  });
  readonly lastGood = signal<GoodCheck | null>(null); // of an earlier state of the form, while it is wrong
  readonly problem = computed<FieldProblem | null>(() => {
    const found = this.checks.last.value?.answer.problem;
    if (this.startProblem.value !== null) return this.startProblem.value;
    if (this.checks.failure.value !== null) return { field: '', text: this.checks.failure.value };
    return found ?? null;
  });
  readonly chosenEngine = computed<SearchEngine>(() => (this.engine.value === 'best' && this.lastGood.value?.reduced === null ? 'reduced' : null));
  readonly method = computed(() => {
    const experiment = this.experiment.value;
    const methods = this.host.page.state.searchMethods.value?.methods ?? [];
    return methods.find(({ tag, algorithm }) => tag === experiment?.method && (algorithm ?? '') === experiment.algorithm);
  });
  readonly name = computed(() => this.typedName.value ?? (this.experiment.value === null ? '' : proposedName(this.experiment.value, this.taken())));
  readonly workerCount = computed(() => this.workers.value ?? this.host.page.state.searches.value?.processors ?? 1);
  // How long it takes in seconds; null: not measured as it is now.
  readonly duration = computed(() => {
    const planned = this.check.value?.planned ?? null;
    return planned === null || this.measured.value?.key !== this.key.value ? null : planned * this.measured.value.evaluation_s;
  });
  private readonly key = computed(() => {
    const draft = this.host.draft.value;
    return this.experiment.value === null ? '' : durationKey(this.experiment.value, this.chosenEngine.value, this.workerCount.value, [draft?.run, draft?.layout, draft?.file]);
  });

  constructor(
    private readonly host: SearchHost,
    after: (ms: number, action: () => void) => void,
  ) {
    const { operations } = host.page;
    this.checks = new NewestAnswer(async (experiment) => (await operations.ask('search.check', { experiment })) as SearchCheck, after, checkDelay);
    effect(() => {
      if (this.check.value !== null) this.lastGood.value = this.check.value;
    });
    // While it is edited it is checked, also after a change of the draft.
    effect(() => {
      const experiment = this.experiment.value;
      const draft = this.host.draft.value;
      if (experiment === null || draft === null || !this.isOpen.value || !this.host.isSearchShown.value) return;
      untracked(() => this.checks.want(plainExperiment(experiment)));
    });
    // A preset measures again when something has changed that evaluations depend on.
    effect(() => {
      const key = this.key.value;
      const isReady = this.isOpen.value && this.host.isSearchShown.value && this.check.value !== null && !this.checks.isWaiting.value;
      const isRefused = key === this.failedKey.value;
      if (this.preset.value === null || !isReady || isRefused || this.host.obstacle() !== null || this.isMeasuring.value) return;
      untracked(() => (this.measuring = this.measure(key)));
    });
  }

  // Opens the form, with the experiment of the last search as far as the draft has its parameters.
  open(): void {
    const draft = this.host.draft.peek();
    const methods = this.host.page.state.searchMethods.peek()?.methods;
    this.isOpen.value = true;
    this.startProblem.value = null;
    if (draft === null || methods === undefined) return;
    const kept = this.experiment.peek();
    const fitting = kept === null ? null : fitToDraft(kept, draft);
    if (fitting !== null && fitting.parameters.length > 0) this.experiment.value = fitting;
    else this.beginAnew();
  }

  // The defaults for the draft.
  beginAnew(): void {
    const draft = this.host.draft.peek();
    const methods = this.host.page.state.searchMethods.peek()?.methods;
    if (draft === null || methods === undefined) return;
    this.engine.value = 'best';
    this.workers.value = null;
    this.typedName.value = null;
    this.preset.value = 'half_minute';
    this.startProblem.value = null;
    this.experiment.value = newExperiment(draft, this.host.page.state.algorithms.peek(), methods);
  }

  change(part: Partial<Experiment>): void {
    const experiment = this.experiment.peek();
    this.startProblem.value = null;
    if (experiment !== null) this.experiment.value = { ...experiment, ...part };
  }

  setEvaluations(text: string): void {
    this.preset.value = null;
    this.change({ evaluations: text });
  }

  choosePreset(preset: TimePreset): void {
    this.startProblem.value = null;
    this.preset.value = preset;
    this.failedKey.value = null;
    this.applyPreset();
  }

  // Fills the form from an experiment file. Returns the reason if it does not fit the draft, else null.
  async read(file: string): Promise<string | null> {
    try {
      const { experiment } = (await this.host.page.operations.ask('search.read', { file })) as { experiment: Experiment };
      this.preset.value = null;
      this.typedName.value = null;
      this.startProblem.value = null;
      // A file without a rating maximises the distance.
      this.experiment.value = experiment.objectives.length > 0 ? experiment : { ...experiment, objectives: [newObjective('distance')] };
      return null;
    } catch (error) {
      return (error as Error).message;
    }
  }

  // Starts the search. Returns its name; null: it was refused, and `problem` says why.
  async start(): Promise<string | null> {
    if (this.isStarting.peek()) return null;
    this.isStarting.value = true;
    this.startProblem.value = null;
    try {
      await this.checks.settle();
      await this.measuring; // a preset still has no number of evaluations
      await this.checks.settle();
      const experiment = this.experiment.peek();
      if (experiment === null || this.problem.peek() !== null) return null;
      return await this.ask({ name: this.name.peek().trim(), experiment: plainExperiment(experiment), engine: this.chosenEngine.peek(), workers: this.workerCount.peek() });
    } catch (error) {
      this.startProblem.value = fieldProblem((error as Error).message);
      return null;
    } finally {
      this.isStarting.value = false;
    }
  }

  // Starts an experiment file as it is. Returns the name of the search. Rejects with the reason of a refusal.
  startFile(file: string, title: string): Promise<string> {
    return this.ask({ name: freeName(title.split('/').at(-1) ?? title, this.taken()), file, engine: null, workers: this.workerCount.peek() });
  }

  private taken(): string[] {
    return this.host.page.state.searches.value?.searches.map(({ name }) => name) ?? [];
  }

  private async ask(words: Operations['search.start']): Promise<string> {
    const { name } = (await this.host.page.operations.ask('search.start', words)) as { name: string };
    this.isOpen.value = false;
    this.typedName.value = null;
    return name;
  }

  private async measure(key: string): Promise<void> {
    if (this.measured.peek()?.key === key) {
      this.applyPreset();
      return;
    }
    const experiment = this.experiment.peek();
    if (experiment === null) return;
    this.isMeasuring.value = true;
    try {
      const words = { experiment: plainExperiment(experiment), engine: this.chosenEngine.peek(), workers: this.workerCount.peek() };
      const { evaluation_s } = (await this.host.page.operations.ask('search.estimate', words)) as SearchEstimate;
      this.measured.value = { key, evaluation_s };
      if (key === this.key.peek()) this.applyPreset();
    } catch (error) {
      this.failedKey.value = key;
      this.startProblem.value = { field: 'preset', text: (error as Error).message };
    } finally {
      this.isMeasuring.value = false;
    }
  }

  private applyPreset(): void {
    const preset = timePresets.find(({ name }) => name === this.preset.peek());
    const measured = this.measured.peek();
    const experiment = this.experiment.peek();
    if (preset === undefined || experiment === null || measured?.key !== this.key.peek()) return;
    const next = withEvaluations(experiment, this.method.peek(), evaluationsIn(preset.seconds, measured.evaluation_s));
    if (next.evaluations !== experiment.evaluations || next.settings['generations'] !== experiment.settings['generations']) this.experiment.value = next;
  }
}
