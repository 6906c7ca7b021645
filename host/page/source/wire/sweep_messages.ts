// Messages about sweeps, in the part Search of the page Make (docs/page-interface.md).

// Of one that cannot be read only the name and the problem are known.
export type SweepState = 'running' | 'stopping' | 'ended' | 'interrupted' | 'unreadable';

export interface SweepEntry {
  name: string; // path of its folder
  state: SweepState;
  scenario: string;
  started: string; // ISO 8601
  measure: string;
  unit: string;
  quantities: { name: string; unit: string; count: number }[];
  made: number; // runs
  planned: number;
  left_s: number | null;
  problem: string | null;
}

export interface SweepsDocument {
  processors: number;
  sweeps: SweepEntry[]; // the newest first
}

// What is swept, as `proleg sweep` takes it.
export interface SweepForm {
  over: string[]; // "amplitude:J3=10:50:5"
  measure: string;
  engine: 'reduced' | null; // null: that of the scenario
  workers: number;
}

// The value of `sweep.check`. `reduced`: why the reduced engine cannot simulate the draft.
export type SweepCheck = { engine: string; reduced: string | null } & (
  | { problem: { field: string; text: string } } // "over.0"
  | { problem?: undefined; runs: number; counts: number[]; has_equal_seeds: boolean }
);

// The value of `sweep.estimate`.
export interface SweepEstimate {
  run_s: number; // of one run on one processor
  seconds: number; // of all of them
}

export interface SweptQuantity {
  name: string;
  unit: string;
  is_seed: boolean;
  values: string[];
}

// The value of `sweep.open`.
export interface OpenedSweep {
  name: string;
  measure: string;
  options: string; // the command
  planned: number; // runs
  cells: number;
  quantities: SweptQuantity[];
  joints: number | null; // null: the scenario cannot be read any more
  scenario_problem: string | null;
}

// Of a combination without the seed: mean, standard deviation, number of values, number of runs without a value.
export type SweepCellRow = [number | null, number | null, number, number];

// The value of `sweep.cells`.
export interface SweepCells {
  from: number;
  made: number; // runs that the cells have
  cells: SweepCellRow[];
}

// The value of `sweep.cell`.
export interface SweepCell {
  cell: number;
  words: string[]; // as for `behaviour.values`
  others: string[]; // of the world and its start: "friction=0.2"
  failure: string | null; // of the first run that failed
}
