// The search that is shown: what it is, its evaluations, and the candidate that is chosen in it.
import { computed, signal } from '@preact/signals-core';
import type { Adaptation, OpenedSearch, SearchAdaptations, SearchCandidate, SearchConfirmation, SearchEntry, SearchRows } from '../../wire/messages.js';
import { Front } from './front.js';
import { GaitMap } from './gait_map.js';
import { Ranking } from './ranking.js';
import { RowReader } from './row_reader.js';
import { RowStore } from './row_store.js';
import type { SearchHost } from './search_host.js';
import { isRead } from './search_text.js';

const tablePeriod = 500; // milliseconds: the tables and charts follow at most twice a second
const openPeriod = 2000; // milliseconds after which a search is opened again that could not be
const adaptationPeriod = 2000; // milliseconds between two looks at the adaptations that have the map of the search

// The evaluations of one repetition.
export interface ShownRows {
  id: number; // other rows have another one
  reader: RowReader;
  store: RowStore;
  rankings: readonly Ranking[]; // by objective
  front: Front | null; // of two objectives
  map: GaitMap | null; // of a search that has one
}

export class ChosenSearch {
  readonly opened = signal<OpenedSearch | null>(null);
  readonly problem = signal<string | null>(null); // why it cannot be shown
  readonly run = signal(0);
  readonly objective = signal(0); // by which the charts and the table are
  readonly dimension = signal(0); // of the chart of points
  readonly isFrontListed = signal(false); // the table has the front in place of the best
  readonly rows = signal<ShownRows | null>(null);
  readonly shownCount = signal(0); // evaluations that tables show
  readonly number = signal<number | null>(null); // of the candidate that is chosen
  readonly candidate = signal<SearchCandidate | null>(null);
  readonly candidateProblem = signal<string | null>(null);
  readonly confirmation = signal<SearchConfirmation | 'running' | null>(null); // whether the candidate's gait is real
  readonly pointedCell = signal<number | null>(null); // of the map
  readonly adaptations = signal<Adaptation[]>([]); // that have this map
  // The adaptation whose trials are shown: the newest, unless another one or none was chosen.
  readonly adaptation = computed(() => {
    const name = this.adaptationName.value;
    return (name === null ? this.adaptations.value[0] : this.adaptations.value.find((each) => each.name === name)) ?? null;
  });
  readonly ranking = computed(() => this.rows.value?.rankings[this.objective.value] ?? null);
  private readonly adaptationName = signal<string | null>(null); // '': none; null: nothing was chosen
  private adaptationsAskedAt = -Infinity;
  private rowsBegun = 0;
  private openedOf = ''; // state of the search when it was opened
  private openedAt = -Infinity;
  private isOpening = false;
  private shownAt = -Infinity;
  private isClosed = false;

  constructor(
    private readonly host: SearchHost,
    readonly name: string,
    private readonly confirmations: Map<string, SearchConfirmation> | null = null, // of all searches, by name, repetition and candidate; null: they are forgotten
  ) {}

  close(): void {
    this.isClosed = true;
    this.rows.peek()?.reader.close();
  }

  // To be called at each frame while it is shown. `entry`: of the document `searches`; undefined: it is not there.
  advance(now: number, entry: SearchEntry | undefined): void {
    if (entry === undefined) return;
    // At its end it has a result, and after it was resumed another number of evaluations.
    const key = `${entry.state}/${entry.planned ?? ''}`;
    const isDue = key !== this.openedOf ? this.problem.peek() === null || now - this.openedAt >= openPeriod : false;
    if (isDue && !this.isOpening && isRead(entry)) {
      this.openedAt = now;
      void this.open(key);
    }
    const rows = this.rows.peek();
    if (rows === null) return;
    if (rows.map !== null && now - this.adaptationsAskedAt >= adaptationPeriod) {
      this.adaptationsAskedAt = now;
      void this.readAdaptations();
    }
    // The list has the evaluations of all repetitions together, not of each.
    const announced = this.opened.peek()?.runs === 1 ? entry.made : 0;
    rows.reader.advance(now, announced, entry.state === 'running' || entry.state === 'stopping');
    if (rows.store.count !== this.shownCount.peek() && now - this.shownAt >= tablePeriod) {
      this.shownAt = now;
      rows.rankings.forEach((ranking) => ranking.update());
      rows.front?.update();
      rows.map?.update();
      this.shownCount.value = rows.store.count;
    }
  }

  // Shows another repetition.
  chooseRun(run: number): void {
    this.run.value = run;
    this.chooseCandidate(null);
    this.beginRows();
  }

  // name: '' for none.
  chooseAdaptation(name: string): void {
    this.adaptationName.value = name;
  }

  chooseCandidate(number: number | null): void {
    this.number.value = number;
    this.candidate.value = null;
    this.candidateProblem.value = null;
    this.confirmation.value = this.confirmations?.get(`${this.name}/${this.run.peek()}/${number}`) ?? null;
    if (number !== null) void this.readCandidate(number);
  }

  // Has the program check whether the gait of the candidate is real.
  async confirm(): Promise<void> {
    const number = this.number.peek();
    const run = this.run.peek();
    if (number === null || this.confirmation.peek() === 'running') return;
    const isWanted = () => this.number.peek() === number && this.run.peek() === run && !this.isClosed;
    this.confirmation.value = 'running';
    this.candidateProblem.value = null;
    try {
      const confirmation = (await this.host.page.operations.ask('search.confirm', { name: this.name, run, number })) as SearchConfirmation;
      this.confirmations?.set(`${this.name}/${run}/${number}`, confirmation);
      if (isWanted()) this.confirmation.value = confirmation;
    } catch (error) {
      if (!isWanted()) return;
      this.confirmation.value = null;
      this.candidateProblem.value = (error as Error).message;
    }
  }

  private async open(key: string): Promise<void> {
    this.isOpening = true;
    try {
      const opened = (await this.host.page.operations.ask('search.open', { name: this.name })) as OpenedSearch;
      if (this.isClosed) return;
      this.openedOf = key;
      this.problem.value = null;
      const before = this.opened.peek();
      this.opened.value = opened;
      const isOther = before?.dimensions.length !== opened.dimensions.length || before.objectives.length !== opened.objectives.length;
      if (isOther) this.beginRows();
    } catch (error) {
      if (!this.isClosed) this.problem.value = (error as Error).message;
    } finally {
      this.isOpening = false;
    }
  }

  private beginRows(): void {
    const opened = this.opened.peek();
    this.rows.peek()?.reader.close();
    this.shownCount.value = 0;
    this.shownAt = -Infinity;
    this.pointedCell.value = null;
    if (opened === null) return;
    const store = new RowStore(opened.objectives.length, opened.dimensions.length);
    const run = this.run.peek();
    const reader = new RowReader(store, async (from) => (await this.host.page.operations.ask('search.rows', { name: this.name, run, from })) as SearchRows);
    const rankings = opened.objectives.map(({ maximise }, objective) => new Ranking(store, objective, maximise));
    const [first, second] = opened.objectives;
    const front = opened.objectives.length === 2 ? new Front(store, [first!.maximise, second!.maximise]) : null;
    const map = opened.axes.length === 0 ? null : new GaitMap(store, opened.axes, opened.centroids, first!.maximise);
    this.rows.value = { id: ++this.rowsBegun, reader, store, rankings, front, map };
  }

  private async readAdaptations(): Promise<void> {
    // Without a connection the page says so.
    const answer = (await this.host.page.operations.ask('search.adaptations', { name: this.name }).catch(() => null)) as SearchAdaptations | null;
    if (answer === null || this.isClosed) return;
    if (JSON.stringify(answer.adaptations) !== JSON.stringify(this.adaptations.peek())) this.adaptations.value = answer.adaptations;
  }

  private async readCandidate(number: number): Promise<void> {
    const run = this.run.peek();
    const isWanted = () => this.number.peek() === number && this.run.peek() === run;
    try {
      const candidate = (await this.host.page.operations.ask('search.candidate', { name: this.name, run, number })) as SearchCandidate;
      if (isWanted()) this.candidate.value = candidate;
    } catch (error) {
      if (isWanted()) this.candidateProblem.value = (error as Error).message;
    }
  }
}
