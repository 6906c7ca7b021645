// Messages of the page Modules: what is done with modules on a bus (docs/page-interface.md).

// A node as the last scan has found it. Of one that does not answer little is known.
export interface ScannedNode {
  node: number;
  answers: boolean;
  state: string | null; // NMT state
  drive?: string | null;
  error_register?: number | null;
  serial?: number | null;
  name?: string | null;
  hardware?: string | null;
  software?: string | null;
}

export interface ScanResult {
  nodes: ScannedNode[];
  fresh_modules?: boolean; // there are modules without a node id
  modules_without_node_id?: boolean; // the same, as `proleg scan` prints it
  duplicate_node_ids?: number[];
}

export interface ImageFile {
  file: string;
  version: string;
  commit: string | null;
  board: number;
  sha256: string;
  problem: string | null; // why it cannot be flashed
}

export interface PlacedJoint {
  name: string;
  node: number;
  serial: number | null; // of the module that the robot's file names
}

export interface ModulesDocument {
  bus: string | null; // null: none is open
  is_fixed: boolean; // the program was started with this bus
  description: string | null;
  offers: { address: string; text: string }[];
  robot: { document: 'robot' | 'draft_robot'; name: string; joints: PlacedJoint[] } | null; // whose places are given
  images: ImageFile[];
  settings: string[];
  found: ScanResult | null;
}

export interface ModuleRef {
  node: number; // 0: none
  serial: number;
}

export interface FlashVerdict extends ModuleRef {
  board: number;
  before: { version: string } | null;
  action: 'flash' | 'same' | 'refuse';
  reason: string;
}

export interface FlashProgress extends ModuleRef {
  part: number; // 0 to 1
  state: string;
}

export interface FlashOutcome extends ModuleRef {
  outcome: string | null;
  good: boolean;
}

// What is wrong with a module, and what `recover` does about it.
export interface ModuleTrouble {
  code: string;
  what: string;
  to_do: string;
  by_hand: boolean;
}

export interface PlacedModule extends ModuleRef {
  joint: string | null;
}

// The newest event of each name.
export interface JobEvents {
  verdicts?: { version: string; sha256: string; modules: FlashVerdict[] };
  progress?: { modules: FlashProgress[] };
  ended?: { modules: FlashOutcome[] };
  found?: { modules: (ModuleRef & { found: ModuleTrouble[] })[] };
  waits?: ModuleWait;
  numbered?: { count: number };
  moves?: ModuleRef & { degrees: number };
  cannot_move?: ModuleRef & { problem: string };
  places?: { modules: PlacedModule[] };
  refused?: { text: string };
  reading?: { node: number; reading: number; angle: number | null };
}

export interface NodeChange {
  serial: number;
  from: number;
  to: number;
  joint: string | null;
}

// A wait for modules that are silent; 0 s are left when it has ended.
export interface ModuleWait {
  seconds: number;
  left_s: number;
  seen: number; // modules
}

// What waits for an answer.
export type JobQuestion = { number: number } & (
  | ({ question: 'joint' } & ModuleRef)
  | { question: 'agree'; changes: NodeChange[] }
  | { question: 'lower' | 'upper'; node: number }
);

export type JobKind = 'scan' | 'examine' | 'save' | 'compare' | 'load' | 'assign' | 'calibrate' | 'flash' | 'recover';

export interface ModuleJob {
  number: number;
  kind: JobKind;
  state: 'running' | 'ending' | 'ended';
  by: string;
  command: string; // that does the same in a shell
  latest: JobEvents;
  question: JobQuestion | null;
  lines: string[];
  result: unknown; // see JobResults
  status: number | null; // null: a signal has ended it
  error: string | null;
  ended_by: string | null;
}

// What the programs print with --json, as far as the page shows it.
export interface FlashedModule extends FlashVerdict, FlashOutcome {
  now: { version: string } | null;
  changed_settings?: string[]; // those that the new program has changed
}

export interface RecoveredModule {
  serial: number;
  node_before: number;
  node: number;
  version: string | null;
  present: boolean;
  well: boolean;
  found: ModuleTrouble[];
  done: (string | ModuleTrouble)[];
  remains: ModuleTrouble[];
  problem: string | null;
}

export interface Finding {
  code: string;
  what: string;
  to_do: string;
  nodes: number[];
}

export interface SettingsDifference {
  node: number;
  object: string;
  name: string;
  found: string;
  wanted: string;
}

export interface JobResults {
  scan: ScanResult;
  examine: { findings: Finding[]; observations: Record<string, unknown> };
  save: { modules: number[] }; // node ids
  compare: { differences: SettingsDifference[]; other_modules: string[]; without_gait: string[] };
  load: { changed: number; stored: boolean };
  assign: { joints: { joint: string; node: number | null; serial: number | null }[]; changed: boolean; new_modules: number };
  calibrate: { node: number; now: { at_minus_90: number; at_plus_90: number } };
  flash: { dry_run: boolean; version: string; modules: FlashedModule[]; silent_nodes?: number[] };
  recover: { dry_run: boolean; well: boolean; modules: RecoveredModule[]; missing: (number | string)[] };
}

// The member without which a result cannot be shown.
const neededMembers: Partial<Record<JobKind, string>> = {
  scan: 'nodes',
  examine: 'findings',
  save: 'modules',
  compare: 'differences',
  assign: 'joints',
  flash: 'modules',
  recover: 'modules',
};

// The result of the last job if it is of this kind and complete, else null.
export function resultOf<Kind extends JobKind>(job: ModuleJob | null, kind: Kind): JobResults[Kind] | null {
  if (job === null || job.kind !== kind || typeof job.result !== 'object' || job.result === null) return null;
  const needed = neededMembers[kind];
  const isComplete = needed === undefined || Array.isArray((job.result as Record<string, unknown>)[needed]);
  return isComplete ? (job.result as JobResults[Kind]) : null;
}

// The value of `modules.read`.
export interface ObjectValue {
  node: number;
  object: string; // "0x2009:2"
  name: string;
  group: string;
  value: string; // with its unit
  writable?: boolean;
  help?: string;
}

export interface ModuleOperations {
  'modules.look': Record<string, never>;
  'modules.open': { bus: string };
  'modules.close': Record<string, never>;
  'modules.scan': Record<string, never>;
  'modules.examine': { bus?: string }; // the bus only if none is open
  'modules.read': { node: number; all: boolean };
  'modules.set': { node: number; object: string; value: string; store: boolean };
  'modules.save': { file: string; nodes: string };
  'modules.compare': { file: string };
  'modules.load': { file: string; store: boolean; any_module: boolean };
  'modules.assign': { amplitude: number };
  'modules.calibrate': { node: number };
  'modules.flash': {
    image: string;
    nodes: string | null;
    canary: boolean;
    dry_run: boolean;
    force_board: boolean;
    allow_downgrade: boolean;
  };
  'modules.recover': { image: string | null; wait: number; serials: number[]; reset_settings: boolean; dry_run: boolean };
  'modules.answer': { job: number; question: number; word: string };
  'modules.cancel': { job: number };
}
