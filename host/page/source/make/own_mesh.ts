// A mesh that a person has brought along: on its way to the program, refused, or there, with what it shall become.
import { computed, signal } from '@preact/signals-core';
import type { OperationQueue } from '../state/operations.js';
import { bytesResultHeader } from '../wire/bytes_result.js';
import type { MeshFit, SentMesh } from '../wire/messages.js';
import { isPlausible, sidesOf, suggestedUnit, turnedSides, type Purpose } from './mesh_scale.js';
import { readShape, type MeshShape } from './mesh_shape.js';
import { sendMesh, type MeshFile } from './mesh_transfer.js';

const usualDensity = 500; // kg/m^3: a module of 72 x 52 x 52 mm weighs 100 g
const longestName = 30; // characters

export type Quarters = readonly [number, number, number];

export type MeshState =
  | { phase: 'none' }
  | { phase: 'sending'; name: string; share: number }
  | { phase: 'refused'; reason: string }
  | { phase: 'there'; mesh: SentMesh };

// What is done with a mesh: each returns the reason of a refusal, or null.
export interface MeshPorts {
  operations: Pick<OperationQueue, 'ask'>;
  obstacle(): string | null; // why nothing can be changed
  addObject(words: MeshFit & { sheet: boolean }): Promise<string | null>;
  makeModule(words: MeshFit & { name: string; length: number; mass: number; links: readonly number[] }): Promise<string | null>;
}

export class OwnMesh {
  readonly state = signal<MeshState>({ phase: 'none' });
  readonly purpose = signal<Purpose>('world');
  readonly isOpen = signal(false); // the form is shown
  readonly factor = signal<number | null>(null); // metres of the file's unit; null: not chosen yet
  readonly quarters = signal<Quarters>([0, 0, 0]);
  readonly colour = signal<readonly [number, number, number]>([0.6, 0.5, 0.4]);
  readonly isSheet = signal(false);
  readonly shape = signal<MeshShape | null>(null);
  // Of a module. Null: what the mesh suggests.
  readonly links = signal<readonly number[] | null>(null); // null: all
  readonly name = signal<string | null>(null);
  readonly length = signal<number | null>(null); // metres between two joints
  readonly mass = signal<number | null>(null); // kg
  readonly module = computed(() => this.suggestedModule());
  readonly problem = signal<string | null>(null); // why it was not added
  readonly mesh = computed(() => (this.state.value.phase === 'there' ? this.state.value.mesh : null));
  private attempt = 0; // counts what was chosen, so that an earlier transfer has no effect

  constructor(private readonly ports: MeshPorts) {}

  open(purpose: Purpose): void {
    if (this.purpose.peek() !== purpose) this.close();
    this.purpose.value = purpose;
    this.isOpen.value = true;
  }

  // Forgets the mesh.
  close(): void {
    this.isOpen.value = false;
    this.links.value = null;
    this.reset();
  }

  private reset(): void {
    this.attempt += 1;
    const mesh = this.mesh.peek();
    if (mesh !== null) void this.ports.operations.ask('mesh.drop', { mesh: mesh.mesh }).catch(() => {});
    this.state.value = { phase: 'none' };
    this.factor.value = null;
    this.quarters.value = [0, 0, 0];
    this.isSheet.value = false;
    this.shape.value = null;
    this.problem.value = null;
    this.name.value = null;
    this.length.value = null;
    this.mass.value = null;
  }

  // What the module is that a person has not changed yet: as long as the mesh, as heavy as other modules of its size.
  private suggestedModule(): { name: string; length: number; mass: number } | null {
    const mesh = this.mesh.value;
    const factor = this.factor.value;
    if (mesh === null || factor === null) return null;
    const round = (value: number, digits: number) => Number(value.toPrecision(digits));
    const along = turnedSides(sidesOf(mesh, factor), this.quarters.value)[1];
    return {
      name: this.name.value ?? mesh.name.replace(/\.[^.]*$/, '').slice(0, longestName),
      length: this.length.value ?? round(along, 4),
      mass: this.mass.value ?? round(usualDensity * (mesh.hull_volume ?? 0) * factor ** 3, 3),
    };
  }

  // What was dropped, or chosen. A mesh of the world that needs no answer is added at once.
  async take(files: readonly MeshFile[], purpose: Purpose): Promise<void> {
    this.open(purpose);
    this.reset();
    const attempt = this.attempt;
    const isCancelled = () => attempt !== this.attempt;
    const name = files.find((file) => !/\.mtl$/i.test(file.name))?.name ?? '';
    const obstacle = this.ports.obstacle();
    if (files.length === 0 || obstacle !== null) {
      this.state.value = { phase: 'refused', reason: obstacle ?? 'What was dropped is no file.' };
      return;
    }
    this.state.value = { phase: 'sending', name, share: 0 };
    try {
      const progress = (share: number) => {
        if (!isCancelled()) this.state.value = { phase: 'sending', name, share };
      };
      const mesh = await sendMesh(this.ports.operations, files, { isCancelled, progress });
      if (mesh === null || isCancelled()) return;
      await this.arrive(mesh);
    } catch (error) {
      if (!isCancelled()) this.state.value = { phase: 'refused', reason: (error as Error).message };
    }
  }

  private async arrive(mesh: SentMesh): Promise<void> {
    const purpose = this.purpose.peek();
    const refusal = purpose === 'world' ? mesh.flaw : mesh.hull_volume === null ? 'its points lie in a plane' : null;
    if (refusal !== null) {
      void this.ports.operations.ask('mesh.drop', { mesh: mesh.mesh }).catch(() => {});
      this.state.value = { phase: 'refused', reason: `${mesh.name}: found ${refusal}${purpose === 'world' ? ', expected triangles whose corners are not on one line' : ', expected a solid'}` };
      return;
    }
    this.state.value = { phase: 'there', mesh };
    if (isPlausible(mesh, 1, purpose)) {
      this.factor.value = 1;
      if (purpose === 'world' && mesh.gap === null && (await this.add()) === null) return;
    } else {
      this.factor.value = suggestedUnit(mesh, purpose)?.metres ?? null;
    }
    try {
      const buffer = (await this.ports.operations.ask('mesh.shape', { mesh: mesh.mesh })) as ArrayBuffer;
      if (this.mesh.peek() === mesh) this.shape.value = readShape(buffer, bytesResultHeader);
    } catch {
      // The numbers are enough.
    }
  }

  // Makes the chosen links modules of this mesh. Returns the reason if it was refused, else null.
  async makeModule(): Promise<string | null> {
    const mesh = this.mesh.peek();
    const factor = this.factor.peek();
    const module = this.module.peek();
    if (mesh === null || factor === null || module === null) return 'choose how long one unit of the file is';
    const words = { mesh: mesh.mesh, factor, quarters: this.quarters.peek(), colour: this.colour.peek(), ...module, links: this.links.peek() ?? [] };
    this.problem.value = await this.ports.makeModule(words);
    if (this.problem.peek() === null) this.close();
    return this.problem.peek();
  }

  // Adds it to the world. Returns the reason if it was refused, else null.
  async add(): Promise<string | null> {
    const mesh = this.mesh.peek();
    const factor = this.factor.peek();
    if (mesh === null || factor === null) return 'choose how long one unit of the file is';
    const words = { mesh: mesh.mesh, factor, quarters: this.quarters.peek(), colour: this.colour.peek(), sheet: this.isSheet.peek() };
    this.problem.value = await this.ports.addObject(words);
    if (this.problem.peek() === null) this.close();
    return this.problem.peek();
  }
}
