// The stores of the part Search of the page Make: the searches that there are, the one that is shown, and the form of a new one.
import { computed, effect, signal, untracked } from '@preact/signals-core';
import type { SearchConfirmation } from '../../wire/messages.js';
import { onFrame } from '../../view/frame_clock.js';
import { ChosenSearch } from './chosen_search.js';
import { MotionLoader, type WantedMotion } from './motion_loader.js';
import { NewSearch } from './new_search.js';
import type { SearchHost } from './search_host.js';

const refreshPeriod = 2000; // milliseconds
const lookPeriod = 100; // milliseconds between two looks at what is to be asked
const longestFrame = 250; // milliseconds: a tab that was hidden goes on where it was

let stores: SearchApp | null = null; // what was typed stays when another part is shown

// The only one of the page.
export function searchApp(host: SearchHost): SearchApp {
  if (stores === null) {
    const app = new SearchApp(host, (ms, action) => void setTimeout(action, ms));
    // Hidden tabs have no frames, so nothing is asked there.
    onFrame((now) => app.advance(now));
    stores = app;
  }
  return stores;
}

export class SearchApp {
  readonly form: NewSearch;
  readonly motions: MotionLoader;
  readonly chosen = signal<ChosenSearch | null>(null);
  readonly otherMotion = signal<WantedMotion | null>(null); // of a sweep, while no candidate is chosen
  readonly problem = signal<string | null>(null); // of what was asked of the chosen search
  readonly entries = computed(() => this.host.page.state.searches.value?.searches ?? []);
  readonly entry = computed(() => this.entries.value.find(({ name }) => name === this.host.chosenSearch.value));
  private readonly confirmations = new Map<string, SearchConfirmation>(); // they stay when another search is chosen
  private refreshedAt = -Infinity;
  private isRefreshing = false;
  private lookedAt = -Infinity;
  private last = 0;

  constructor(
    readonly host: SearchHost,
    after: (ms: number, action: () => void) => void,
  ) {
    this.form = new NewSearch(host, after);
    this.motions = new MotionLoader(host, after);
    effect(() => {
      const name = host.chosenSearch.value;
      untracked(() => {
        this.chosen.peek()?.close();
        this.problem.value = null;
        this.chosen.value = name === null ? null : new ChosenSearch(host, name, this.confirmations);
      });
    });
    effect(() => {
      const chosen = this.chosen.value;
      const opened = chosen?.opened.value ?? null;
      const number = chosen?.number.value ?? null;
      const run = chosen?.run.value ?? 0;
      const wanted = chosen === null || opened === null || number === null ? this.otherMotion.value : { name: chosen.name, run, number, joints: opened.joints };
      untracked(() => this.motions.want(wanted));
    });
    // What can be in the form is known only now.
    effect(() => {
      const isKnown = this.host.page.state.searchMethods.value !== null && this.host.draft.value !== null;
      if (isKnown && this.form.isOpen.value && this.form.experiment.value === null) untracked(() => this.form.open());
    });
  }

  // To be called at each frame.
  advance(now: number): void {
    const milliseconds = Math.min(longestFrame, Math.max(0, now - this.last));
    this.last = now;
    if (!this.host.isSearchShown.peek()) return;
    this.host.motion.peek()?.advance(milliseconds);
    if (now - this.lookedAt < lookPeriod) return;
    this.lookedAt = now;
    if (!this.isRefreshing && now - this.refreshedAt >= refreshPeriod) {
      this.refreshedAt = now;
      void this.refresh();
    }
    this.chosen.peek()?.advance(now, this.entry.peek());
  }

  choose(name: string | null): void {
    this.host.chosenSearch.value = name;
  }

  async start(): Promise<void> {
    this.show(await this.form.start());
  }

  // Returns the reason if it was refused, else null.
  async startFile(file: string, title: string): Promise<string | null> {
    try {
      this.show(await this.form.startFile(file, title));
      return null;
    } catch (error) {
      return (error as Error).message;
    }
  }

  stop(): Promise<void> {
    const name = this.host.chosenSearch.peek();
    return name === null ? Promise.resolve() : this.attempt(this.host.page.operations.ask('search.stop', { name }));
  }

  resume(evaluations: string): Promise<void> {
    const name = this.host.chosenSearch.peek();
    const workers = this.form.workerCount.peek();
    return name === null ? Promise.resolve() : this.attempt(this.host.page.operations.ask('search.resume', { name, evaluations, workers }));
  }

  // Puts the values of the chosen candidate into the draft.
  async apply(): Promise<void> {
    const chosen = this.chosen.peek();
    const candidate = chosen?.candidate.peek() ?? null;
    if (chosen === null || candidate === null) return;
    const label = `candidate ${candidate.number} of ${chosen.name.split('/').at(-1) ?? ''}`;
    chosen.candidateProblem.value = await this.host.setValues(candidate.words, label);
  }

  private show(name: string | null): void {
    if (name === null) return;
    this.choose(name);
    this.refreshedAt = -Infinity;
  }

  private async attempt(asked: Promise<unknown>): Promise<void> {
    try {
      await asked;
      this.problem.value = null;
      this.refreshedAt = -Infinity;
    } catch (error) {
      this.problem.value = (error as Error).message;
    }
  }

  private async refresh(): Promise<void> {
    this.isRefreshing = true;
    // Without a connection the page says so.
    await this.host.page.operations.ask('search.refresh', {}).catch(() => {});
    this.isRefreshing = false;
  }
}
