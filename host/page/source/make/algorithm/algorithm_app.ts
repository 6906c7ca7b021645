// The stores of the part Algorithm of the page Make: the algorithm that is open, what was typed, and what the program builds.
import { computed, signal } from '@preact/signals-core';
import type { Stores } from '../../view/robot_view.js';
import type { AlgorithmForm, AlgorithmSource } from '../../wire/messages.js';
import { textParts } from './text_parts.js';

// What the part needs of the page Make.
export interface AlgorithmHost {
  readonly page: Stores<'operations' | 'state'>;
}

// A source as it is typed. It stays when another one is opened.
export interface OpenSource extends AlgorithmSource {
  folder: string;
  typed: string;
}

let stores: AlgorithmApp | null = null; // what was typed stays when another part is shown

// The only one of the page.
export function algorithmApp(make: AlgorithmHost): AlgorithmApp {
  stores ??= new AlgorithmApp(make);
  return stores;
}

export class AlgorithmApp {
  readonly sources = signal<ReadonlyMap<string, OpenSource>>(new Map());
  readonly chosen = signal<string | null>(null); // folder
  readonly isMaking = signal(false); // the form of a new one is shown
  readonly problem = signal<string | null>(null);
  // Where the editor goes, once for each new object.
  readonly place = signal<{ line: number; column: number } | null>(null);

  readonly source = computed(() => (this.chosen.value === null ? null : (this.sources.value.get(this.chosen.value) ?? null)));
  readonly isChanged = computed(() => this.source.value !== null && this.source.value.typed !== this.source.value.text);
  readonly build = computed(() => {
    const build = this.make.page.state.algorithmBuild.value;
    return build?.folder === this.chosen.value ? build : null;
  });
  readonly check = computed(() => {
    const check = this.make.page.state.algorithmCheck.value;
    return check?.folder === this.chosen.value ? check : null;
  });
  // The work that goes on, of any algorithm.
  readonly work = computed(() => {
    const { algorithmBuild, algorithmCheck, algorithmImage } = this.make.page.state;
    if (algorithmImage.value?.state === 'running') return { name: 'the image', isImage: true };
    const work = [algorithmBuild.value, algorithmCheck.value].find((each) => each?.state === 'running');
    return work == null ? null : { name: work.name, isImage: false };
  });
  // Folders of the algorithms that come into the image; null: the one that is open.
  readonly inImage = signal<ReadonlySet<string> | null>(null);
  readonly imageProblem = signal<string | null>(null);

  constructor(readonly make: AlgorithmHost) {
    // A page that is left loses what was not saved.
    window.addEventListener('beforeunload', (event) => {
      if ([...this.sources.peek().values()].some(({ text, typed }) => text !== typed)) event.preventDefault();
    });
  }

  // The reason why nothing can be written or built; null: it can.
  obstacle(): string | null {
    const { state } = this.make.page;
    if (!state.isConnected.value) return 'No connection to the program.';
    return state.isHolder.value ? null : 'Take control first (C).';
  }

  async open(folder: string): Promise<void> {
    this.problem.value = null;
    this.isMaking.value = false;
    this.chosen.value = folder;
    const known = this.sources.peek().get(folder);
    if (known !== undefined && known.text !== known.typed) return;
    try {
      const source = (await this.make.page.operations.ask('algorithm.read', { folder })) as AlgorithmSource;
      const now = this.sources.peek().get(folder);
      if (now !== undefined && now.text !== now.typed) return; // typed meanwhile
      this.keep({ ...source, folder, typed: source.text });
    } catch (error) {
      this.problem.value = (error as Error).message;
    }
  }

  // What is on disk, in place of what was typed.
  async openAgain(): Promise<void> {
    const source = this.source.peek();
    if (source === null) return;
    this.keep({ ...source, typed: source.text });
    await this.open(source.folder);
  }

  type(folder: string, typed: string): void {
    const source = this.sources.peek().get(folder);
    if (source !== undefined && source.typed !== typed) this.keep({ ...source, typed });
  }

  // Returns the reason if it was refused, else null.
  async create(form: AlgorithmForm): Promise<string | null> {
    try {
      const { folder } = (await this.make.page.operations.ask('algorithm.create', form)) as { folder: string };
      await this.open(folder);
      return null;
    } catch (error) {
      return (error as Error).message;
    }
  }

  // Returns whether the file has what was typed.
  async save(): Promise<boolean> {
    const source = this.source.peek();
    if (source === null) return false;
    this.problem.value = null;
    const parts = textParts(source.typed);
    try {
      let version = source.version;
      for (const [part, text] of parts.entries()) {
        const more = part + 1 < parts.length;
        const answer = await this.make.page.operations.ask('algorithm.save', { folder: source.folder, version: source.version, text, part, more });
        version = (answer as { version: string | null }).version ?? version;
      }
      const now = this.sources.peek().get(source.folder);
      this.keep({ ...source, typed: now?.typed ?? source.typed, text: source.typed, version });
      return true;
    } catch (error) {
      this.problem.value = (error as Error).message;
      return false;
    }
  }

  async begin(name: 'algorithm.build' | 'algorithm.check'): Promise<void> {
    const folder = this.chosen.peek();
    if (folder === null || !(await this.save())) return;
    try {
      await this.make.page.operations.ask(name, { folder });
    } catch (error) {
      this.problem.value = (error as Error).message;
    }
  }

  async buildImage(folders: readonly string[]): Promise<void> {
    this.imageProblem.value = null;
    const source = this.source.peek();
    if (source !== null && folders.includes(source.folder) && !(await this.save())) return;
    try {
      await this.make.page.operations.ask('algorithm.image', { folders });
    } catch (error) {
      this.imageProblem.value = (error as Error).message;
    }
  }

  cancel(): void {
    void this.make.page.operations.tell('algorithm.cancel', {});
  }

  private keep(source: OpenSource): void {
    this.sources.value = new Map(this.sources.peek()).set(source.folder, source);
  }
}
