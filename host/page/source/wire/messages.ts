// The messages of docs/page-interface.md, as types.
import type {
  AlgorithmBuild,
  AlgorithmCheck,
  AlgorithmDocument,
  AlgorithmFolders,
  AlgorithmForm,
  AlgorithmImage,
  DraftDocument,
  ForesightDocument,
  GalleryEntry,
  JointValues,
  LibraryItem,
  MeshFit,
  MissingAlgorithms,
  NewScenario,
  PartOperation,
  PartsDocument,
  RunDocument,
  ServoDocument,
} from './make_messages.js';
import type { ClassDocument, ClassOperations } from './class_messages.js';
import type { ModuleJob, ModuleOperations, ModulesDocument } from './module_messages.js';
import type { InternalValue, Parameter, PoseArray } from './robot_messages.js';
import type { Experiment, SearchEngine, SearchesDocument, SearchMethodsDocument } from './search_messages.js';
import type { SweepForm, SweepsDocument } from './sweep_messages.js';

export type * from './class_messages.js';
export type * from './make_messages.js';
export type * from './module_messages.js';
export type * from './robot_messages.js';
export type * from './search_messages.js';
export type * from './sweep_messages.js';

export const protocol = 1;

// Raw value of a signal that has no value at a tick.
export const noValue = -2147483648;

export interface Signal {
  name: string;
  unit: string;
  scale: number; // value in `unit` = raw * scale
  count: number; // values in a tick
  of: 'joint' | 'link' | 'robot';
}

export interface TelemetryDocument {
  hash: number;
  tick_us: number;
  signals: Signal[];
}

export interface Shape {
  kind: 'box' | 'sphere' | 'cylinder' | 'mesh';
  pose: PoseArray;
  size: [number, number, number]; // half sides; radius; radius and half height, along y; half sides of the box around a mesh
  mesh?: number; // of a mesh: its number in `meshes`
}

// A surface of triangles, about the middle of the box around it.
export interface Mesh {
  vertices: string; // base64 of float32: x, y, z of each, metres
  triangles: string; // base64 of uint32: three numbers of vertices of each
  colours: string; // base64 of uint8: red, green, blue of each vertex; empty: none
}

// A scale on the ground: segments whose colours alternate.
export interface Ruler {
  from: [number, number, number]; // metres, in the world
  to: [number, number, number];
  division: number; // metres, of a segment
  width: number;
}

export interface Body {
  name: string;
  pose: PoseArray;
  shapes: Shape[];
}

export interface Joint {
  name: string;
  node: number;
  lower: number; // degrees
  upper: number;
  anchor: [number, number, number]; // metres, in the robot's frame at angles 0
  axis: [number, number, number];
}

export interface Slot {
  number: number;
  algorithm: string;
  joints: number[];
}

// Joints and links count from the head; joint j connects link j with link j + 1.
export interface RobotDocument {
  name: string;
  file: string;
  kind: 'simulation' | 'bus' | 'recording' | 'draft';
  joints: Joint[];
  links: Body[];
  terrain: Body[];
  objects?: Body[]; // that move; the signal `object` has their poses
  rulers?: Ruler[];
  meshes?: Mesh[];
  slots: Slot[];
}

// What `proleg` has recorded.
export interface RecordingDocument {
  file: string;
  program: string;
  build_id: string;
  core_fingerprint: string;
  seed: string;
  finished: boolean;
  first_tick: number;
  last_tick: number;
  has_path: boolean; // false: the place of the robot was not measured
  results: { name: string; value: string }[];
  marks: Mark[]; // by ascending tick
}

// A recording behind a server, which reads the file while it shows it.
export interface ServedRecordingDocument extends RecordingDocument {
  indexed: number; // ticks from the first on whose smallest and largest values are known
  damage: string | null; // reason why a part of the ticks cannot be read
}

// The place of the recordings of this program.
export interface RecordingsDocument {
  folder: string;
  open: string | null; // file to show at once
  alone: boolean; // there is no robot
}

// The value of `recording.compare`: set-points and motion of two recordings in the ticks that both have.
export interface RunComparison {
  first_tick: number;
  last_tick: number;
  compared: number; // number of ticks that were compared until now
  difference: { tick: number; joint: string } | null; // the first one of the set-points
  motion?: { difference: { tick: number; part: string } | null } | null; // null: a robot was not simulated
  damage: string | null; // reason why the comparison cannot continue
  head_m: [number | null, number | null]; // distance that each head moved, in metres
}

// A file of `recording.list`. What was not read yet, or cannot be read, is missing.
export interface RecordedFile {
  name: string;
  bytes: number;
  time_ms: number; // time of the last change, since 1970
  described: boolean;
  program?: string;
  scenario?: string;
  algorithms?: string[];
  joints?: number;
  seconds?: number;
  finished?: boolean;
  problem?: string | null;
}

export interface Mark {
  kind: 'change' | 'fault' | 'restart' | 'move' | 'loss';
  tick: number;
  text: string;
}

interface CommonSession {
  run: number;
  tick: number;
  time_s: number;
  stopped_by?: string | null;
  recording: string | null;
  changed: boolean;
  undo: string | null;
  redo: string | null;
  failure: string | null;
}

export interface SimulationSession extends CommonSession {
  kind?: 'simulation';
  state: 'paused' | 'running' | 'stopped' | 'failed';
  factor: number; // 0: as fast as it goes
  measured_factor: number | null;
  set: 'A' | 'B';
  head?: [number, number, number, number, number, number, number]; // now: x, y, z, then the quaternion w, x, y, z
  moved?: boolean; // whether the robot was moved by hand since the last tick
  last_move?: number | null; // tick of the last move by hand
  repeats?: { file: string; tick: number } | null; // the recording that is computed again, up to this tick
  recent_speed?: number | null; // m/s, over the last two strides
  servo_problem?: string | null; // why the servos did not follow the gait in the last four seconds
  measures?: Record<string, number>;
}

// Comparison of the modules' state frames with the gait of this computer, in the present or last run.
export interface GaitComparison {
  compared: number;
  differences: number;
  missing: number;
  first_difference: string | null;
  end: string | null; // reason why nothing is compared any more
}

export interface BusSession extends CommonSession {
  kind: 'bus';
  state: 'off' | 'starting' | 'held' | 'running' | 'stopping' | 'failed';
  gait: GaitComparison | null; // null: no run yet
  started_with: 'power' | 'run' | null;
}

export type SessionDocument = SimulationSession | BusSession;

export interface BusModule {
  node: number;
  joint: number | null; // null: the module does not belong to this robot
  state: string | null; // NMT state
  drive: string | null;
  angle: number | null; // degrees
  current: number | null; // mA
  current_limit: number | null; // mA; 0: off
  temperature: number | null; // degrees Celsius
  fault: string | null;
  advice: string | null; // what to do
  silent: boolean;
  stop_confirmed: boolean | null; // whether the module has confirmed the last STOP
  contacts?: number | null; // bits 0, 1: rear and front sensor of the link behind the joint; 2, 3: of the link in front, at the head
}

export interface BusDocument {
  address: string;
  connected: boolean;
  problem: string | null;
  load: number; // 0 to 1
  syncs: number; // number of SYNCs in the last second
  other_host: boolean;
  latency_ms: number | null;
  modules: BusModule[];
}

export interface ControlDocument {
  epoch: number;
  holder: { client: number; name: string } | null;
  away: boolean;
  request: { client: number; name: string; ms: number } | null;
}

export interface RemoteElement {
  name: string; // the kernel's: ABS_X, BTN_SOUTH
  kind: 'axis' | 'button';
}

// With `action`, or with `parameters` and all that follows.
export interface RemoteBinding {
  device: string;
  element: string;
  action?: string;
  parameters?: string[];
  method?: 'linear';
  lower?: number;
  upper?: number;
  step?: number;
  dead_zone?: number;
  curve?: number;
  take_up?: boolean;
}

export interface RemoteDocument {
  devices: { id: number; name: string; elements: RemoteElement[] }[];
  bindings: RemoteBinding[];
  problems: string[];
  learning: boolean;
  active: boolean; // whether a viewer drives
  file: string | null;
  saved: boolean;
}

export interface RemoteValues {
  devices: { id: number; positions: number[] }[];
  bindings: ({ value: number; taken: boolean[] } | null)[];
}

// The seat of a class at which this program is.
export interface SeatDocument {
  name: string;
  is_teacher: boolean;
  has_modules: boolean;
}

// A scenario that the teacher has handed out.
export interface HandedOut {
  number: number; // ascending
  file: string; // of `gallery`
  title: string;
}

// The installation of the program, and whether an update has replaced it.
export interface ProgramDocument {
  version: string;
  has_documentation: boolean;
  is_replaced: boolean; // its files, while it runs
  is_other_version: boolean; // than the program that serves the page
}

export interface Documents {
  program: ProgramDocument;
  gallery: { entries: GalleryEntry[] };
  algorithm_folders: AlgorithmFolders;
  algorithm_build: AlgorithmBuild;
  algorithm_check: AlgorithmCheck;
  algorithm_image: AlgorithmImage;
  missing_algorithms: MissingAlgorithms | null;
  searches: SearchesDocument;
  search_methods: SearchMethodsDocument;
  sweeps: SweepsDocument;
  draft: DraftDocument | null; // null: there is no scenario
  draft_robot: RobotDocument;
  draft_meshes: Mesh[];
  library: LibraryItem[];
  parts: PartsDocument;
  algorithms: AlgorithmDocument[];
  foresight: ForesightDocument;
  robot: RobotDocument;
  parameters: (Parameter | InternalValue)[];
  session: SessionDocument;
  bus: BusDocument | null; // null: no bus is open
  control: ControlDocument;
  telemetry: TelemetryDocument;
  remote: RemoteDocument;
  remote_values: RemoteValues;
  recordings: RecordingsDocument;
  modules: ModulesDocument;
  module_job: ModuleJob | null; // null: there was none yet
  class: ClassDocument; // only for the page of a class
  seat: SeatDocument; // only in a class
  handed_out: HandedOut[]; // only in a class; the oldest first
}

export type DocumentMessage = {
  [Name in keyof Documents]: { type: 'document'; name: Name; revision: number; value: Documents[Name] };
}[keyof Documents];

export interface ResultMessage {
  type: 'result';
  id: number;
  ok: boolean;
  value?: unknown;
  error?: string;
}

export interface NoticeMessage {
  type: 'notice';
  number?: number; // missing if it is for this viewer alone
  level: 'info' | 'warning' | 'error';
  text: string;
}

export interface WelcomeMessage {
  type: 'welcome';
  protocol: number;
  client: number;
  program: string;
  next_notice: number; // of the first notice that is still to come
}

export interface StoppedMessage {
  type: 'stopped';
  confirmed: number;
  of: number;
  ms: number;
}

export type ServerMessage = WelcomeMessage | DocumentMessage | ResultMessage | NoticeMessage | StoppedMessage;

// Names and arguments of the operations that the page uses.
// The value of `file.diff`.
export interface FileDiff {
  diff: string;
  is_shipped: boolean; // the file ships with Proleg: only a copy can be written
  entries: FileDiffEntry[];
}

export interface FileDiffEntry {
  file: string;
  line: number; // line that changes, or after which the new line comes
  old: string | null; // null: the line is new
  new: string;
  slot: number;
  name: string;
  joints: number[];
}

export interface Operations extends ClassOperations, ModuleOperations {
  'algorithm.refresh': Record<string, never>;
  'algorithm.read': { folder: string };
  'algorithm.create': AlgorithmForm;
  'algorithm.save': { folder: string; version: string; text: string; part: number; more: boolean };
  'algorithm.build': { folder: string };
  'algorithm.check': { folder: string };
  'algorithm.image': { folders: readonly string[] };
  'algorithm.cancel': Record<string, never>;
  'draft.new': NewScenario;
  'draft.open': { file: string; discard?: boolean }; // a file of `gallery`
  'draft.take': { file: string; parts: readonly ('robot' | 'actuation' | 'environment')[] };
  'gallery.look': Record<string, never>;
  'draft.undo': Record<string, never>;
  'draft.redo': Record<string, never>;
  'draft.run': { [Name in keyof RunDocument]: { name: Name; value: RunDocument[Name] } }[keyof RunDocument];
  'draft.refresh': Record<string, never>;
  'draft.restore': Record<string, never>;
  'draft.discard': Record<string, never>;
  'draft.diff': Record<string, never>;
  'draft.copy': { layout: number; objects: readonly number[] };
  'draft.save': Record<string, never>;
  'draft.save_as': { folder: string };
  load_draft: Record<string, never>;
  'world.place': PartOperation & { object: number; pose: PoseArray; group?: boolean };
  'world.resize': PartOperation & { object: number; shape: number; size: number[] };
  'world.friction': PartOperation & { object: number; value: number | null };
  'world.colour': PartOperation & { object: number; value: [number, number, number] };
  'world.moves': PartOperation & { object: number; value: boolean };
  'world.mass': PartOperation & { object: number; value: number };
  'world.rename': PartOperation & { object: number; name: string };
  'world.remove': PartOperation & { objects: readonly number[]; group?: boolean };
  'world.duplicate': PartOperation & { objects: readonly number[]; group?: boolean; step: [number, number, number]; count: number };
  'world.paste': PartOperation & { text: string; step: [number, number, number] };
  'world.add': PartOperation & { item: string; values: Record<string, number>; position: [number, number, number]; turn: number };
  'mesh.begin': { files: { name: string; bytes: number }[] };
  'mesh.part': { mesh: number; file: number; at: number; data: string }; // base64
  'mesh.look': { mesh: number };
  'mesh.shape': { mesh: number };
  'mesh.drop': { mesh: number };
  'world.add_mesh': PartOperation & MeshFit & { sheet: boolean; position: [number, number, number]; turn: number };
  'robot.own_module': PartOperation & MeshFit & { name: string; length: number; mass: number; links: readonly number[] };
  'world.start': PartOperation & { position: [number, number, number]; degrees: [number, number, number] };
  'world.ruler': PartOperation & { ruler?: number; from: [number, number, number]; to: [number, number, number] };
  'world.remove_ruler': PartOperation & { ruler: number };
  'robot.axis': PartOperation & { joints: readonly number[]; value: readonly [number, number, number] };
  'robot.limits': PartOperation & { joints: readonly number[]; lower: number; upper: number };
  'robot.torque': PartOperation & { joints: readonly number[]; value: number };
  'robot.speed': PartOperation & { joints: readonly number[]; value: number };
  'robot.rename_joint': PartOperation & { joint: number; name: string };
  'robot.table': PartOperation & { joints: readonly JointValues[]; count?: number };
  'robot.rename': PartOperation & { name: string };
  'robot.servo': PartOperation & { name: keyof ServoDocument; value: number };
  'robot.mass': PartOperation & { link: number; value: number };
  'robot.friction': PartOperation & { link: number; value: number | null };
  'robot.duplicate': PartOperation & { joint: number };
  'robot.remove': PartOperation & { joint: number };
  'robot.count': PartOperation & { value: number };
  'robot.order': PartOperation & { order: readonly number[] };
  'robot.move': PartOperation & { joint: number; to: number };
  'robot.kind': PartOperation & { kind: string; link: number | null };
  'robot.add_sensor': PartOperation & { kind: string; part: number; place?: string };
  'robot.remove_sensor': PartOperation & { sensor: number };
  'robot.rename_sensor': PartOperation & { sensor: number; name: string };
  'robot.place_sensor': PartOperation & { sensor: number; pose: PoseArray };
  'robot.sensor_part': PartOperation & { sensor: number; part: number };
  'robot.set_sensor': PartOperation & { sensor: number; name: string; value: string };
  'behaviour.add': PartOperation & { algorithm: string; joints: readonly number[] };
  'behaviour.duplicate': PartOperation & { module: number; joints: readonly number[] };
  'behaviour.remove': PartOperation & { module: number };
  'behaviour.algorithm': PartOperation & { module: number; algorithm: string };
  'behaviour.joints': PartOperation & { module: number; joints: readonly number[] };
  'behaviour.set': PartOperation & { module: number; parameter: string; joints: readonly number[]; value: string };
  'behaviour.values': PartOperation & { words: readonly string[]; label: string };
  'search.refresh': Record<string, never>;
  'search.open': { name: string };
  'search.rows': { name: string; run: number; from: number };
  'search.candidate': { name: string; run: number; number: number };
  'search.adaptations': { name: string };
  'search.motion': { name: string; run: number; number: number } | Record<string, never>; // without a name that of the draft
  'search.check': { experiment: Experiment };
  'search.read': { file: string };
  'search.estimate': { experiment: Experiment; engine: SearchEngine; workers: number };
  'search.confirm': { name: string; run: number; number: number };
  'search.start': { name: string; engine: SearchEngine; workers: number } & ({ experiment: Experiment } | { file: string });
  'search.stop': { name: string };
  'search.resume': { name: string; evaluations: string; workers: number };
  'sweep.refresh': Record<string, never>;
  'sweep.open': { name: string };
  'sweep.cells': { name: string; measure: string | null; from: number };
  'sweep.cell': { name: string; cell: number };
  'sweep.motion': { name: string; cell: number };
  'sweep.check': SweepForm;
  'sweep.estimate': SweepForm;
  'sweep.start': SweepForm & { name: string };
  'sweep.stop': { name: string };
  'sweep.resume': { name: string; workers: number };
  'control.take': Record<string, never>;
  'control.answer': { grant: boolean };
  'control.release': Record<string, never>;
  run: Record<string, never>;
  pause: Record<string, never>;
  step: { ticks: number };
  restart: { parameters?: 'file' };
  factor: { value: number };
  set: { words: string[]; gesture: number };
  undo: Record<string, never>;
  redo: Record<string, never>;
  swap: Record<string, never>;
  reset: { names?: string[] }; // as in `set`, without a value
  move: { position: readonly [number, number, number]; turn: number };
  record: { file: string | null };
  command_line: Record<string, never>;
  'file.diff': Record<string, never>;
  'file.apply': { diff: string; entries: number[] };
  'file.save_as': { folder: string }; // a new folder beside the recordings
  'recording.list': Record<string, never>;
  'recording.open': { file: string };
  'recording.rows': { file: string; signals: readonly string[]; from: number; to: number; points: number };
  'recording.compare': { file: string; with: string };
  continue: { file: string; tick: number };
  power: { on: boolean };
  pose: { angles: (number | null)[]; speed: number };
  scan: Record<string, never>;
  ping: Record<string, never>;
  'remote.bind': { binding: RemoteBinding; place?: number };
  'remote.unbind': { place: number };
  'remote.learn': { end?: boolean };
  'remote.save': Record<string, never>;
  'remote.watch': Record<string, never>;
}

export type ClientMessage =
  | { type: 'hello'; protocol: number; token: string; name: string; only?: 'stop'; wants_control?: boolean }
  | { type: 'operation'; id: number; epoch: number; name: keyof Operations; arguments: object }
  | { type: 'subscribe'; signals: string[]; hash: number; newest: boolean }
  | { type: 'beat'; age_ms: number }
  | { type: 'stop' };

const mostNameCharacters = 60;

// The name of a viewer, of at most as many characters as the protocol allows; a character outside the basic plane is not cut.
export function fittingName(name: string): string {
  return [...name].slice(0, mostNameCharacters).join('');
}
