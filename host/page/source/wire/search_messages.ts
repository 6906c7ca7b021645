// Messages of the part Search of the page Make: searches for a gait (docs/page-interface.md).

// Of one that is unread, or cannot be read, only the name and the problem are known.
export type SearchState = 'running' | 'stopping' | 'ended' | 'interrupted' | 'unreadable' | 'unread';

export interface SearchEntry {
  name: string; // path of its folder
  state: SearchState;
  method: string;
  scenario: string;
  started: string; // ISO 8601
  made: number; // evaluations
  planned: number | null; // it ends after so many at the latest
  best: number | null; // number of the evaluation with the best score, by the first objective
  score: number | null;
  objective: string;
  unit: string;
  left_s: number | null;
  ending: string | null; // why it ended
  problem: string | null;
}

export interface ExperimentFile {
  file: string;
  title: string;
  is_shipped: boolean;
}

export interface SearchesDocument {
  processors: number;
  experiments: ExperimentFile[]; // files with searches that can be started
  searches: SearchEntry[]; // the newest first
}

export interface MethodSetting {
  name: string;
  kind: 'whole' | 'number' | 'choice';
  default: string; // empty: the method decides
  lowest: number | null;
  highest: number | null;
  choices?: string[];
  help: string;
}

export interface SearchMethod {
  tag: string;
  algorithm: string | null; // of the tag `pagmo`
  title: string;
  help: string;
  objectives: 'one' | 'several' | 'any';
  has_map: boolean; // whether it needs axes
  settings: MethodSetting[];
}

export interface Measure {
  name: string;
  unit: string;
  help: string;
  higher_is_better: boolean;
  may_be_negative: boolean;
}

// What an experiment can have.
export interface SearchMethodsDocument {
  methods: SearchMethod[];
  measures: Measure[];
  most_objectives: number;
  most_axes: number;
}

// A parameter that the search chooses. Numbers are texts, as a person writes them; an empty one stands for the default.
export interface ChosenParameter {
  module: number; // position in `behaviour` of the draft
  parameter: string;
  joints: number[] | null; // null: all that the module moves; kernel order
  same: boolean; // one value for all of them
  lower: string; // one number, or one for each joint in the order of the robot's file
  upper: string;
  step: string;
  with_lower: boolean; // the limit is one of the values
  with_upper: boolean;
  set: string | null; // the values, in place of the range
}

export interface ObjectiveTerm {
  measure: string;
  weight: string;
}

export interface Objective {
  name: string;
  goal: '' | 'maximise' | 'minimise';
  failed: string; // score of a run that failed
  terms: ObjectiveTerm[];
}

// A measure that a map of gaits is divided by.
export interface ExperimentAxis {
  measure: string;
  lowest: string;
  highest: string;
  cells: string; // empty in a map with centroids
}

export interface Trials {
  count: string;
  aggregate: '' | 'mean' | 'worst';
  random_numbers: '' | 'common' | 'fresh';
  friction: string;
  mass: string;
  servo_gain: string;
  latency: string; // ms
  contact_noise: string;
}

// All that an experiment file has (docs/optimisation-files.md).
export interface Experiment {
  method: string; // a tag
  algorithm: string;
  settings: Record<string, string>;
  parameters: ChosenParameter[];
  objectives: Objective[];
  axes: ExperimentAxis[]; // only of a method with a map
  heading: string;
  evaluations: string;
  seed: string;
  reuse: boolean;
  trials: Trials | null;
  confirmation: { candidates: string; runs: string } | null;
  racing: { after: string; keep: string } | null;
}

export type SearchEngine = 'reduced' | null; // null: that of the scenario

// The value of `search.check`: a field of the experiment that is wrong, or what it is.
export type SearchCheck =
  | { problem: { field: string; text: string } }
  | {
      problem?: undefined;
      names: string[]; // of the dimensions
      candidates: number;
      planned: number | null; // evaluations, with that of the scenario's own values
      text: string; // the experiment file
      engine: string; // that of the scenario
      reduced: string | null; // why the reduced engine cannot simulate it
    };

// The value of `search.estimate`.
export interface SearchEstimate {
  evaluation_s: number; // seconds between two evaluations with all workers
  planned: number | null;
  seconds: number | null;
  engine: string;
}

// The value of `search.confirm`: whether a gait is real.
export interface SearchConfirmation {
  nothing_speaks_against: boolean;
  findings: { name: string; good: boolean | null; text: string }[]; // null: it could not be looked at
}

export interface Dimension {
  name: string;
  unit: string;
  count: number; // of its values
  lowest: number;
  highest: number;
}

export interface SearchObjective {
  name: string;
  unit: string;
  maximise: boolean;
}

// What `proleg optimise --json` prints, as far as the page shows it.
export interface SearchResult {
  engine: string;
  judge?: string; // the engine that has judged the best candidates
  best_number: number;
  best_score: number;
  best_search_scores: Record<string, number>; // by objectives
  confirmed_mean: number | null;
  confirmed_standard_deviation: number | null;
  confirmations: { number: number; runs: number; mean: number; worst: number }[];
  baseline: { score: number | null; failure?: string; moved: { dimension: string; scenario: unknown; baseline: unknown }[] } | null;
  better_than_baseline: boolean | null;
  gain_percent: number | null;
  at_bounds: { dimension: string; value: number; bound: 'lowest' | 'highest' }[];
  failed?: number; // evaluations
}

// The value of `search.open`.
export interface OpenedSearch {
  name: string;
  experiment: string; // file name
  method: string;
  engine: string;
  seed: string;
  trials: number;
  planned: number | null;
  runs: number; // repetitions
  joints: number;
  objectives: SearchObjective[];
  dimensions: Dimension[];
  measures: string[];
  has_baseline: boolean; // evaluation 0 has the scenario's own values
  axes: MapAxis[]; // of a map of gaits; [] if the search has none
  centroids: number[][] | null; // of its cells, a coordinate for each axis: 0 at the lowest, 1 at the highest value; null: a grid
  result: SearchResult | null; // of a search that has ended
}

// Of a map of gaits. Its measure is the objective behind the first one, in the order of the axes.
export interface MapAxis {
  name: string;
  unit: string;
  lowest: number;
  highest: number;
  cells: number; // 0 if the map has centroids
}

// A trial of a gait of a map on a robot that differs (docs/adaptation.md).
export interface AdaptationTrial {
  cell: string; // its numbers on the axes or of its centroid, from 1: "3,7"
  values: number[]; // one for each dimension
  expected: number; // scores
  deviation: number;
  measured: number;
  failure: string | null; // why it has no score of its own
}

export interface Adaptation {
  name: string; // path of its folder
  robot: string; // what made the trials
  diagnosis: string | null; // what is probably wrong with it: "powerless:J4 92 %, none 6 %"; null: nothing was suspected
  trials: AdaptationTrial[]; // in the order in which they were made
}

// The value of `search.adaptations`, the newest first.
export interface SearchAdaptations {
  adaptations: Adaptation[];
}

export const hasNoScore = 1; // flag: it failed, and has no score of its own for the first objective
export const wasGivenUp = 2; // flag: before its time was over
export const wasKnown = 4; // flag: the same candidate was evaluated before
export const otherHasNoScore = 8; // flag: it has no score of its own for an objective behind the first

// The value of `search.rows`: evaluations one after the other.
export interface SearchRows {
  from: number;
  made: number; // evaluations of the search, of which there may be more than in this answer
  scores: (number | null)[][]; // for each evaluation one for each objective
  values: number[][]; // for each evaluation one for each dimension
  flags: number[];
}

// The value of `search.candidate`.
export interface SearchCandidate {
  number: number;
  scores: (number | null)[];
  words: string[]; // as for `behaviour.values`
  measures: Record<string, number | null>;
  failure: string | null;
  given_up: boolean;
  reused: boolean;
}
