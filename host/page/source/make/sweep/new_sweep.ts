// The form of a new sweep. It stays when another part is shown.
import { computed, effect, signal, untracked } from '@preact/signals-core';
import type { SweepCheck, SweepEstimate, SweepForm } from '../../wire/messages.js';
import { fieldProblem, type FieldProblem } from '../fields/field_problem.js';
import { defaultRange, newExperiment, parameterOf } from '../search/experiment_defaults.js';
import { freeName, plainText } from '../search/experiment_text.js';
import { NewestAnswer } from '../search/newest_answer.js';
import type { EngineChoice } from '../search/new_search.js';
import type { SearchHost } from '../search/search_host.js';

const checkDelay = 250; // milliseconds after the last change
const usualValues = 9; // of a quantity

// What `proleg sweep` sweeps beside parameters and the seed, with values to begin with.
export const worldQuantities = {
  friction: { unit: '', first: '0.1', last: '0.5', step: '0.1' },
  heading: { unit: 'degrees', first: '-90', last: '90', step: '45' },
  x: { unit: 'm', first: '0', last: '0.5', step: '0.1' },
  y: { unit: 'm', first: '0', last: '0.5', step: '0.1' },
} as const;

export type WorldQuantity = keyof typeof worldQuantities;

// A quantity of the form. Numbers are texts, as a person writes them.
export interface Quantity {
  kind: 'parameter' | WorldQuantity;
  module: number; // position in `behaviour` of the draft
  parameter: string;
  joint: string | null; // null: all that the module moves
  first: string;
  last: string;
  step: string;
}

export const mostQuantities = 2;

export class NewSweep {
  readonly isOpen = signal(false);
  readonly quantities = signal<Quantity[]>([]);
  readonly seeds = signal('1'); // so many, from 1 on
  readonly measure = signal('distance');
  readonly engine = signal<EngineChoice>('best');
  readonly workers = signal<number | null>(null); // null: all processors
  readonly typedName = signal<string | null>(null); // null: the proposed one
  readonly isStarting = signal(false);
  readonly isMeasuring = signal(false);
  readonly checks: NewestAnswer<SweepForm, SweepCheck>;
  private readonly measured = signal<{ key: string; run_s: number } | null>(null);
  private readonly failedKey = signal('');
  private readonly startProblem = signal<FieldProblem | null>(null);

  readonly answer = computed(() => this.checks.last.value?.answer ?? null);
  readonly check = computed(() => {
    const answer = this.answer.value;
    return answer === null || answer.problem !== undefined ? null : answer;
  });
  readonly problem = computed<FieldProblem | null>(() => {
    if (this.startProblem.value !== null) return this.startProblem.value;
    if (this.checks.failure.value !== null) return fieldProblem(this.checks.failure.value);
    const problem = this.answer.value?.problem;
    if (problem === undefined) return null;
    // The seeds are behind the quantities.
    return problem.field === `over.${this.quantities.value.length}` ? { ...problem, field: 'seeds' } : problem;
  });
  readonly workerCount = computed(() => this.workers.value ?? this.host.page.state.sweeps.value?.processors ?? 1);
  // By itself: an answer that changes nothing of it must not change the form, which would ask again.
  private readonly isReduced = computed(() => this.engine.value === 'best' && this.answer.value?.reduced === null);
  readonly form = computed<SweepForm>(() => ({
    over: this.over(),
    measure: this.measure.value,
    engine: this.isReduced.value ? 'reduced' : null,
    workers: this.workerCount.value,
  }));
  // How long it takes in seconds; null: not measured as it is now.
  readonly duration = computed(() => {
    const runs = this.check.value?.runs;
    const measured = this.measured.value;
    return runs === undefined || measured?.key !== this.key.value ? null : (runs * measured.run_s) / this.workerCount.value;
  });
  readonly name = computed(() => {
    const taken = this.host.page.state.sweeps.value?.sweeps.map(({ name }) => name) ?? [];
    const names = this.quantities.value.map(({ kind, parameter }) => (kind === 'parameter' ? parameter : kind));
    return this.typedName.value ?? freeName([...names, this.measure.value].join('_'), taken);
  });
  // What the duration of a run depends on.
  private readonly key = computed(() => {
    const draft = this.host.draft.value;
    return JSON.stringify([this.form.value.engine, draft?.run, draft?.layout, draft?.file]);
  });

  constructor(
    private readonly host: SearchHost,
    after: (ms: number, action: () => void) => void,
  ) {
    const { operations } = host.page;
    this.checks = new NewestAnswer(async (form) => (await operations.ask('sweep.check', form)) as SweepCheck, after, checkDelay);
    effect(() => {
      const form = this.form.value;
      if (this.host.draft.value === null || !this.isOpen.value || !this.host.isSearchShown.value) return;
      untracked(() => this.checks.want(form));
    });
    effect(() => {
      const key = this.key.value;
      const isReady = this.isOpen.value && this.host.isSearchShown.value && this.check.value !== null && !this.checks.isWaiting.value;
      if (!isReady || this.isMeasuring.value || this.measured.value?.key === key || this.failedKey.value === key || this.host.obstacle() !== null) return;
      untracked(() => void this.estimate(key));
    });
  }

  open(): void {
    this.isOpen.value = true;
    this.startProblem.value = null;
    const { draft } = this.host;
    const modules = draft.peek()?.behaviour.modules ?? [];
    const fits = ({ kind, module, parameter }: Quantity) => kind !== 'parameter' || modules[module]?.values[parameter] !== undefined;
    this.quantities.value = this.quantities.peek().filter(fits);
    if (this.quantities.peek().length === 0) this.beginAnew();
  }

  beginAnew(): void {
    const draft = this.host.draft.peek();
    if (draft === null) return;
    this.startProblem.value = null;
    this.seeds.value = '1';
    this.measure.value = 'distance';
    this.engine.value = 'best';
    this.workers.value = null;
    this.typedName.value = null;
    const first = newExperiment(draft, this.host.page.state.algorithms.peek(), []).parameters[0];
    this.quantities.value = first === undefined ? [{ kind: 'friction', module: 0, parameter: '', joint: null, ...worldQuantities.friction }] : [this.ofParameter(first.module, first.parameter)];
  }

  // A parameter of all joints, over its useful range.
  ofParameter(module: number, name: string): Quantity {
    const modules = this.host.draft.peek()?.behaviour.modules ?? [];
    const parameter = parameterOf(this.host.page.state.algorithms.peek(), modules[module], name);
    const range = parameter === undefined ? { lower: '0', upper: '1', step: '0.1' } : defaultRange(parameter);
    // Fewer values than a search has: each is simulated.
    const [low, high, fine] = [Number(range.lower), Number(range.upper), Number(range.step)];
    const step = Math.max(1, Math.round((high - low) / (usualValues - 1) / fine)) * fine;
    return { kind: 'parameter', module, parameter: name, joint: null, first: range.lower, last: range.upper, step: String(Number(step.toPrecision(9))) };
  }

  change(place: number, part: Partial<Quantity>): void {
    this.startProblem.value = null;
    this.quantities.value = this.quantities.peek().map((quantity, i) => (i === place ? { ...quantity, ...part } : quantity));
  }

  // Starts the sweep. Returns its name; null: it was refused, and `problem` says why.
  async start(): Promise<string | null> {
    if (this.isStarting.peek()) return null;
    this.isStarting.value = true;
    this.startProblem.value = null;
    try {
      await this.checks.settle();
      if (this.problem.peek() !== null) return null;
      const { name } = (await this.host.page.operations.ask('sweep.start', { ...this.form.peek(), name: this.name.peek().trim() })) as { name: string };
      this.isOpen.value = false;
      this.typedName.value = null;
      return name;
    } catch (error) {
      this.startProblem.value = fieldProblem((error as Error).message);
      return null;
    } finally {
      this.isStarting.value = false;
    }
  }

  // The words of `--over`.
  private over(): string[] {
    const hasModules = (this.host.draft.value?.behaviour.modules.length ?? 0) > 1;
    const words = this.quantities.value.map(({ kind, module, parameter, joint, first, last, step }) => {
      const name = kind === 'parameter' ? `${hasModules ? `${module + 1}.` : ''}${parameter}${joint === null ? '' : `:${joint}`}` : kind;
      return `${name}=${[first, last, step].map(plainText).join(':')}`;
    });
    const seeds = plainText(this.seeds.value);
    return seeds === '' || seeds === '1' ? words : [...words, `seed=1:${seeds}`];
  }

  private async estimate(key: string): Promise<void> {
    this.isMeasuring.value = true;
    try {
      const { run_s } = (await this.host.page.operations.ask('sweep.estimate', this.form.peek())) as SweepEstimate;
      this.measured.value = { key, run_s };
    } catch {
      this.failedKey.value = key; // it is only a help
    } finally {
      this.isMeasuring.value = false;
    }
  }
}
