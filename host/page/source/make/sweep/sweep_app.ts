// The stores of sweeps in the part Search of the page Make: those that there are, the one that is shown, and the form.
import { computed, effect, signal, untracked } from '@preact/signals-core';
import { searchApp, type SearchApp } from '../search/search_app.js';
import type { SearchHost } from '../search/search_host.js';
import { onFrame } from '../../view/frame_clock.js';
import { ChosenSweep } from './chosen_sweep.js';
import { NewSweep } from './new_sweep.js';

const refreshPeriod = 2000; // milliseconds
const lookPeriod = 100; // milliseconds between two looks at what is to be asked

let stores: SweepApp | null = null; // what was typed stays when another part is shown

// The only one of the page.
export function sweepApp(host: SearchHost): SweepApp {
  if (stores === null) {
    const app = new SweepApp(host, searchApp(host), (ms, action) => void setTimeout(action, ms));
    onFrame((now) => app.advance(now));
    stores = app;
  }
  return stores;
}

export class SweepApp {
  readonly form: NewSweep;
  readonly chosen = signal<ChosenSweep | null>(null);
  readonly problem = signal<string | null>(null); // of what was asked of the chosen sweep
  readonly entries = computed(() => this.host.page.state.sweeps.value?.sweeps ?? []);
  readonly entry = computed(() => this.entries.value.find(({ name }) => name === this.host.chosenSweep.value));
  private refreshedAt = -Infinity;
  private isRefreshing = false;
  private lookedAt = -Infinity;

  // search: whose 3D view plays the chosen cell, too.
  constructor(
    readonly host: SearchHost,
    readonly search: SearchApp,
    after: (ms: number, action: () => void) => void,
  ) {
    this.form = new NewSweep(host, after);
    effect(() => {
      const name = host.chosenSweep.value;
      untracked(() => {
        this.chosen.peek()?.close();
        this.problem.value = null;
        this.chosen.value = name === null ? null : new ChosenSweep(host, name);
        if (name !== null) host.chosenSearch.value = null;
      });
    });
    effect(() => {
      if (host.chosenSearch.value !== null) untracked(() => (host.chosenSweep.value = null));
    });
    effect(() => {
      const chosen = this.chosen.value;
      const joints = chosen?.opened.value?.joints ?? null;
      const cell = chosen?.number.value ?? null;
      const wanted = chosen === null || joints === null || cell === null ? null : { name: chosen.name, cell, joints };
      untracked(() => (search.otherMotion.value = wanted));
    });
  }

  // To be called at each frame.
  advance(now: number): void {
    if (!this.host.isSearchShown.peek() || now - this.lookedAt < lookPeriod) return;
    this.lookedAt = now;
    if (!this.isRefreshing && now - this.refreshedAt >= refreshPeriod) {
      this.refreshedAt = now;
      void this.refresh();
    }
    this.chosen.peek()?.advance(now, this.entry.peek());
  }

  choose(name: string | null): void {
    this.host.chosenSweep.value = name;
  }

  async start(): Promise<void> {
    const name = await this.form.start();
    if (name === null) return;
    this.choose(name);
    this.refreshedAt = -Infinity;
  }

  stop(): Promise<void> {
    const name = this.host.chosenSweep.peek();
    return name === null ? Promise.resolve() : this.attempt(this.host.page.operations.ask('sweep.stop', { name }));
  }

  resume(): Promise<void> {
    const name = this.host.chosenSweep.peek();
    const workers = this.form.workerCount.peek();
    return name === null ? Promise.resolve() : this.attempt(this.host.page.operations.ask('sweep.resume', { name, workers }));
  }

  // Puts the values of the chosen cell into the draft.
  async apply(label: string): Promise<void> {
    const chosen = this.chosen.peek();
    const cell = chosen?.cell.peek() ?? null;
    if (chosen === null || cell === null) return;
    chosen.cellProblem.value = await this.host.setValues(cell.words, label);
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
    await this.host.page.operations.ask('sweep.refresh', {}).catch(() => {});
    this.isRefreshing = false;
  }
}
