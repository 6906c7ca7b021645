// The sweep that is shown: what it is, what it has measured, and the cell that is chosen in it.
import { signal } from '@preact/signals-core';
import type { OpenedSweep, SweepCell, SweepCells, SweepEntry } from '../../wire/messages.js';
import type { SearchHost } from '../search/search_host.js';
import { emptyCells, takeCells, type Cells } from './sweep_cells.js';

const cellsPeriod = 1000; // milliseconds from the end of a reading to the next one
const retryPeriod = 2000; // after a refusal

export class ChosenSweep {
  readonly opened = signal<OpenedSweep | null>(null);
  readonly problem = signal<string | null>(null); // why it cannot be shown
  readonly measure = signal<string | null>(null); // null: that for which it was started
  readonly cells = signal<Cells | null>(null); // another object when they have changed
  readonly number = signal<number | null>(null); // of the chosen cell
  readonly pointed = signal<number | null>(null); // under the mouse, or of the keyboard
  readonly cell = signal<SweepCell | null>(null); // that is chosen
  readonly cellProblem = signal<string | null>(null);
  private openedOf = ''; // state of the sweep when it was opened
  private readOf = ''; // what the cells are of
  private nextAt = -Infinity;
  private isAsking = false;
  private isClosed = false;

  constructor(
    private readonly host: SearchHost,
    readonly name: string,
  ) {}

  close(): void {
    this.isClosed = true;
  }

  // To be called at each frame while it is shown. `entry`: of the document `sweeps`; undefined: it is not there.
  advance(now: number, entry: SweepEntry | undefined): void {
    if (entry === undefined || entry.state === 'unreadable' || this.isAsking || this.isClosed || now < this.nextAt) return;
    const wanted = `${entry.made}/${this.measure.peek() ?? ''}`;
    if (this.openedOf !== entry.state) void this.ask(now, () => this.open(entry.state));
    else if (this.readOf !== wanted) void this.ask(now, () => this.read(wanted));
  }

  chooseMeasure(measure: string): void {
    this.measure.value = measure;
    this.nextAt = -Infinity;
  }

  choose(number: number | null): void {
    this.number.value = number;
    this.cell.value = null;
    this.cellProblem.value = null;
    if (number !== null) void this.readCell(number);
  }

  private async ask(now: number, question: () => Promise<void>): Promise<void> {
    this.isAsking = true;
    try {
      await question();
      this.problem.value = null;
    } catch (error) {
      if (!this.isClosed) this.problem.value = (error as Error).message;
      this.nextAt = now + retryPeriod;
    } finally {
      this.isAsking = false;
    }
  }

  private async open(state: string): Promise<void> {
    const opened = (await this.host.page.operations.ask('sweep.open', { name: this.name })) as OpenedSweep;
    if (this.isClosed) return;
    if (this.cells.peek()?.mean.length !== opened.cells) this.cells.value = null;
    this.opened.value = opened;
    this.openedOf = state;
    this.readOf = '';
  }

  // All cells, in several answers.
  private async read(wanted: string): Promise<void> {
    const opened = this.opened.peek();
    if (opened === null) return;
    const cells = emptyCells(opened.cells);
    const measure = this.measure.peek();
    for (let from = 0; from < opened.cells; ) {
      const answer = (await this.host.page.operations.ask('sweep.cells', { name: this.name, measure, from })) as SweepCells;
      if (this.isClosed || measure !== this.measure.peek() || answer.cells.length === 0) return;
      takeCells(cells, answer);
      from += answer.cells.length;
    }
    this.cells.value = cells;
    this.readOf = wanted;
    this.nextAt = performance.now() + cellsPeriod;
  }

  private async readCell(number: number): Promise<void> {
    const isWanted = () => this.number.peek() === number && !this.isClosed;
    try {
      const cell = (await this.host.page.operations.ask('sweep.cell', { name: this.name, cell: number })) as SweepCell;
      if (isWanted()) this.cell.value = cell;
    } catch (error) {
      if (isWanted()) this.cellProblem.value = (error as Error).message;
    }
  }
}
