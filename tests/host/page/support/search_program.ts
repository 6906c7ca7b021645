// A program for the part Search: its answers come when a test gives them, and time passes when a test says so.
import type { MotionPair } from '../../../../host/page/source/make/search/motion.js';
import type { SearchHost } from '../../../../host/page/source/make/search/search_host.js';
import { PageState } from '../../../../host/page/source/state/page_state.js';
import type {
  AlgorithmDocument,
  AlgorithmParameter,
  DraftDocument,
  OpenedSearch,
  RobotDocument,
  SearchEntry,
  SearchMethodsDocument,
  SearchRows,
} from '../../../../host/page/source/wire/messages.js';
import { pageSignal } from './page_signal.js';
import { SteadyClock } from './steady_clock.js';

export const settle = () => new Promise((resolve) => setImmediate(resolve));

export interface Asked {
  name: string;
  words: Record<string, unknown>;
  answer(value: unknown): Promise<void>;
  refuse(reason: string): Promise<void>;
}

const degree = 180 / 2 ** 31;

export function parameter(name: string, part: Partial<AlgorithmParameter> = {}): AlgorithmParameter {
  return { name, unit: 'deg', scale: degree, wraps: false, minimum: 0, maximum: 90 / degree, useful: [0, 60 / degree], default: 40 / degree, help: `What ${name} is.`, ...part };
}

export const sinusoidal: AlgorithmDocument = {
  name: 'PatternGenerator_sinusoidal',
  id: 2,
  help: 'sine',
  own: false,
  touch: false,
  broadcasts: true,
  parameters: [parameter('amplitude'), parameter('frequency', { unit: 'Hz', scale: 2 ** -24, maximum: 20 * 2 ** 24, useful: [Math.round(0.1 * 2 ** 24), 2 * 2 ** 24] })],
};

// A caterpillar with five joints, whose amplitude is 40 degrees.
export function caterpillar(part: Partial<DraftDocument> = {}): DraftDocument {
  const joints = ['J5', 'J4', 'J3', 'J2', 'J1'].map((name) => ({ name, editable: true, axis: [1, 0, 0], limits: [-90, 90], torque: 1, speed: 5 }));
  const all = [0, 1, 2, 3, 4];
  const values = { amplitude: all.map(() => 40 / degree), frequency: all.map(() => 2 ** 24) };
  return {
    file: 'mine/uniform.simulation.xml',
    revision: 1,
    layout: 1,
    robot: { joints },
    behaviour: { file: 'mine/uniform.actuation.xml', modules: [{ algorithm: sinusoidal.name, joints: all, values }] },
    run: { duration: 30, tick: 10, engine: 'ode' },
    ...part,
  } as unknown as DraftDocument;
}

const setting = (name: string, usual: string) => ({ name, kind: 'whole' as const, default: usual, lowest: 0, highest: 1e6, help: name });

export const methods: SearchMethodsDocument = {
  methods: [
    { tag: 'geneticAlgorithm', algorithm: null, title: 'Genetic algorithm', help: 'GAlib', objectives: 'one', has_map: false, settings: [setting('popsize', '30'), setting('gamode', '1')] },
    { tag: 'cmaEs', algorithm: null, title: 'CMA-ES', help: 'learns', objectives: 'one', has_map: false, settings: [setting('popsize', '20'), setting('generations', '1000'), setting('restartAfter', '0')] },
    { tag: 'pagmo', algorithm: 'sade', title: 'SADE', help: 'adapts', objectives: 'one', has_map: false, settings: [setting('popsize', '20')] },
  ],
  measures: [{ name: 'distance', unit: 'm', help: 'how far', higher_is_better: true, may_be_negative: false }],
  most_objectives: 8,
  most_axes: 4,
};

export function entry(part: Partial<SearchEntry> = {}): SearchEntry {
  return {
    name: 'searches/wave',
    state: 'running',
    method: 'cmaes',
    scenario: 'uniform.simulation.xml',
    started: '2026-11-27T23:40:00Z',
    made: 0,
    planned: 2000,
    best: null,
    score: null,
    objective: 'distance',
    unit: 'm',
    left_s: null,
    ending: null,
    problem: null,
    ...part,
  };
}

export function openedSearch(part: Partial<OpenedSearch> = {}): OpenedSearch {
  return {
    name: 'searches/wave',
    experiment: 'wave.optimise.xml',
    method: 'cmaes',
    engine: 'reduced',
    seed: '1',
    trials: 1,
    planned: 2000,
    runs: 1,
    joints: 5,
    objectives: [{ name: 'distance', unit: 'm', maximise: true }],
    dimensions: [{ name: 'amplitude:J5', unit: 'deg', count: 161, lowest: 0, highest: 40 }],
    measures: ['distance'],
    has_baseline: true,
    axes: [],
    centroids: null,
    result: null,
    ...part,
  };
}

// Evaluations from a number on, with one dimension: a score and a value for each.
export function rowsFrom(from: number, scores: readonly number[], made = from + scores.length): SearchRows {
  return { from, made, scores: scores.map((score) => [score]), values: scores.map((_, i) => [(from + i) % 40]), flags: scores.map(() => 0) };
}

export class SearchProgram {
  readonly asked: Asked[] = [];
  readonly state = new PageState();
  readonly clock = new SteadyClock();
  readonly draft = pageSignal<DraftDocument | null>(caterpillar());
  readonly draftRobot = pageSignal<RobotDocument | null>({ joints: [{}, {}, {}, {}, {}] } as unknown as RobotDocument);
  readonly isShown = pageSignal(true); // the part is in front, and there is a connection
  readonly chosen = pageSignal<string | null>(null);
  readonly chosenSweep = pageSignal<string | null>(null);
  readonly motion = pageSignal<MotionPair | null>(null);
  readonly applied: { words: readonly string[]; label: string }[] = [];
  refusal: string | null = null; // of a change of the draft
  drives = true;
  readonly host: SearchHost;

  constructor() {
    this.connect(true);
    this.state.algorithms.value = [sinusoidal];
    this.state.searchMethods.value = methods;
    const ask = (name: string, words: Record<string, unknown>) =>
      new Promise((resolve, reject) => {
        const answer = (value: unknown) => (resolve(value), settle() as Promise<void>);
        const refuse = (reason: string) => (reject(new Error(reason)), settle() as Promise<void>);
        this.asked.push({ name, words, answer, refuse });
      });
    this.host = {
      page: { state: this.state, operations: { ask } } as unknown as SearchHost['page'],
      draft: this.draft,
      draftRobot: this.draftRobot,
      isSearchShown: this.isShown,
      chosenSearch: this.chosen,
      chosenSweep: this.chosenSweep,
      motion: this.motion,
      obstacle: () => (this.drives ? null : 'Take control first (C).'),
      setValues: (words: readonly string[], label: string) => {
        this.applied.push({ words, label });
        return Promise.resolve(this.refusal);
      },
    } as unknown as SearchHost;
  }

  connect(isConnected: boolean): void {
    this.state.connection.value = isConnected ? { state: 'open', client: 1, program: 'proleg', nextNotice: 0 } : { state: 'lost', attempts: 1 };
    this.isShown.value = isConnected;
  }

  publish(...searches: SearchEntry[]): void {
    this.state.searches.value = { processors: 2, experiments: [], searches };
  }

  readonly after = (ms: number, action: () => void) => this.clock.after(ms, action);

  // Lets the time pass, and what waits for it happen.
  async pass(ms: number): Promise<void> {
    this.clock.advance(ms);
    await settle();
  }

  ofName(name: string): Asked[] {
    return this.asked.filter((each) => each.name === name);
  }

  // The last request with this name. Fails if there is none.
  last(name: string): Asked {
    const found = this.ofName(name).at(-1);
    if (found === undefined) throw new Error(`found no request '${name}' in ${this.asked.map((each) => each.name).join(', ')}`);
    return found;
  }
}
