// The offer to build what a scenario lacks: algorithms whose sources are in the project.
import { computed, effect, signal } from '@preact/signals-core';
import type { Stores } from '../../view/robot_view.js';
import type { AlgorithmBuild, BuildMessage, MissingAlgorithms } from '../../wire/messages.js';

// What is done again when the algorithms are there.
export type Repeats = Record<MissingAlgorithms['action'], (file: string) => Promise<void>>;

export class AlgorithmOffer {
  readonly dismissed = signal<MissingAlgorithms | null>(null);
  readonly building = signal<string | null>(null); // name
  readonly problem = signal<string | null>(null);
  // The algorithm that could not be built, and the place of the first error in its source.
  readonly failed = signal<{ folder: string; place: { line: number; column: number } | null } | null>(null);

  readonly missing = computed(() => {
    const missing = this.page.state.missingAlgorithms.value;
    return missing === this.dismissed.value ? null : missing;
  });

  constructor(
    private readonly page: Stores<'operations' | 'state'>,
    private readonly repeats: Repeats,
  ) {
    effect(() => {
      if (this.missing.value === null) this.forget();
    });
  }

  // The reason why they cannot be built here; null: they can.
  obstacle(): string | null {
    const missing = this.missing.value;
    const refusal = this.page.state.algorithmFolders.value?.refusal ?? null;
    if (missing === null) return null;
    const start = (library: string) => `start the program with --algorithms ${library}`;
    const absent = missing.algorithms.filter(({ folder }) => folder === null).map(({ name }) => name);
    if (absent.length > 0) return `The source of ${absent.join(', ')} is not in this project; ${start('PATH, the library that is made of it')}.`;
    if (refusal !== null) return `It cannot be built here: ${refusal}. Or ${start(missing.algorithms.map(({ library }) => library).join(' --algorithms '))}.`;
    return null;
  }

  dismiss(): void {
    this.dismissed.value = this.page.state.missingAlgorithms.peek();
  }

  // Builds and loads all of them, and does again what they were missing for.
  async accept(): Promise<void> {
    const missing = this.missing.peek();
    if (missing === null || this.building.peek() !== null) return;
    this.forget();
    try {
      for (const { name, folder } of missing.algorithms) {
        if (folder === null) continue;
        this.building.value = name;
        const before = this.page.state.algorithmBuild.peek();
        await this.page.operations.ask('algorithm.build', { folder });
        const build = await this.endOf(folder, before);
        if (build.state !== 'passed') {
          const error = firstError(build);
          this.failed.value = { folder, place: error?.file === `${build.name}.cpp` && error.line > 0 ? error : null };
          this.problem.value = build.state === 'cancelled' ? `The build of ${name} was cancelled.` : `The build of ${name} failed: ${errorText(build)}.`;
          return;
        }
      }
      await this.repeats[missing.action](missing.file);
      // Another name in the source than that of its file, for example.
      const still = this.missing.peek();
      if (still !== null && still.file === missing.file) this.problem.value = still.error;
    } catch (error) {
      this.problem.value = (error as Error).message;
    } finally {
      this.building.value = null;
    }
  }

  private forget(): void {
    this.problem.value = null;
    this.failed.value = null;
  }

  // before: the document of the build before, which may come after the answer.
  private endOf(folder: string, before: AlgorithmBuild | null): Promise<AlgorithmBuild> {
    const { state } = this.page;
    return new Promise((resolve, reject) => {
      const stop = effect(() => {
        const build = state.algorithmBuild.value;
        const isConnected = state.isConnected.value;
        if (!isConnected) {
          reject(new Error('The connection was lost while it was built. Try again.'));
        } else if (build !== null && build !== before && build.folder === folder && build.state !== 'running') {
          resolve(build);
        } else {
          return;
        }
        queueMicrotask(() => stop());
      });
    });
  }
}

function firstError({ messages }: AlgorithmBuild): BuildMessage | null {
  return messages.find(({ severity }) => severity === 'error') ?? null;
}

function errorText(build: AlgorithmBuild): string {
  const first = firstError(build);
  return first === null ? (build.error ?? 'no message') : `${first.file}${first.line > 0 ? `, line ${first.line}` : ''}: ${first.text}`;
}
