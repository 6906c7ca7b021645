// The objects of the chosen module, as it has reported them last.
import { computed, effect, signal, untracked, type ReadonlySignal } from '@preact/signals-core';
import type { OperationQueue } from '../state/operations.js';
import type { ObjectValue } from '../wire/messages.js';

interface Reading {
  node: number;
  isAll: boolean;
  values: readonly ObjectValue[];
  at: Date;
}

export class ModuleObjects {
  readonly isAll = signal(false); // all objects, or those that most people need
  readonly filter = signal('');
  readonly reading = signal<Reading | null>(null); // of the chosen module
  readonly isReading = signal(false);
  readonly problem = signal<string | null>(null);
  readonly groups = computed(() => groupsOf(this.reading.value?.values ?? [], this.filter.value));
  private newest = 0; // number of the last request: an answer to an earlier one is late

  constructor(
    private readonly operations: Pick<OperationQueue, 'ask'>,
    private readonly node: ReadonlySignal<number | null>,
  ) {
    effect(() => {
      void node.value;
      untracked(() => this.forget());
    });
  }

  // Unless the values of this module are known.
  async readIfNew(): Promise<void> {
    if (this.reading.peek() === null && !this.isReading.peek() && this.problem.peek() === null) await this.read();
  }

  async read(): Promise<void> {
    const node = this.node.peek();
    if (node === null) return;
    const number = ++this.newest;
    const isAll = this.isAll.peek();
    this.isReading.value = true;
    this.problem.value = null;
    try {
      const { values } = (await this.operations.ask('modules.read', { node, all: isAll })) as { values: ObjectValue[] };
      if (number === this.newest) this.reading.value = { node, isAll, values: values.filter((value) => value.node === node), at: new Date() };
    } catch (error) {
      if (number === this.newest) this.problem.value = (error as Error).message;
    } finally {
      if (number === this.newest) this.isReading.value = false;
    }
  }

  // Writes a value. Returns what the program says of it. Throws an OperationRefused with the reason.
  async write(object: string, value: string, isStored: boolean): Promise<string> {
    const node = this.node.peek();
    if (node === null) return '';
    const answer = (await this.operations.ask('modules.set', { node, object, value, store: isStored })) as { text?: string } | null;
    void this.read();
    return answer?.text ?? '';
  }

  private forget(): void {
    this.newest += 1;
    this.reading.value = null;
    this.isReading.value = false;
    this.problem.value = null;
  }
}

export interface ObjectGroup {
  name: string;
  values: ObjectValue[];
}

// The groups in the order of the program, with the objects whose name, index or help has all words of the text.
export function groupsOf(values: readonly ObjectValue[], text: string): ObjectGroup[] {
  const words = text.toLowerCase().split(/\s+/).filter(Boolean);
  const groups = new Map<string, ObjectValue[]>();
  for (const value of values) {
    const searched = `${value.object} ${value.name} ${value.help ?? ''}`.toLowerCase();
    if (words.every((word) => searched.includes(word))) groups.set(value.group, [...(groups.get(value.group) ?? []), value]);
  }
  return [...groups].map(([name, members]) => ({ name, values: members }));
}
