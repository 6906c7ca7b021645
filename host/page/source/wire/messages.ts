// The messages of docs/page-interface.md, as types.

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

// x, y, z in metres, then a unit quaternion w, x, y, z.
export type PoseArray = [number, number, number, number, number, number, number];

export interface Shape {
  kind: 'box' | 'sphere' | 'cylinder' | 'mesh';
  pose: PoseArray;
  size: [number, number, number]; // half sides; radius; radius and half height, along y; half sides of the box around a mesh
  mesh?: number; // of a mesh: its number in `meshes`
}

// A surface of triangles, about the middle of the box around it.
export interface Mesh {
  vertices: number[]; // x, y, z of each, metres
  triangles: number[]; // three numbers of vertices of each
  colours: number[]; // red, green, blue of each vertex, 0 to 255; empty: none
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

// The value of `recording.compare`: the set-points of two recordings in the ticks that both have.
export interface RunComparison {
  first_tick: number;
  last_tick: number;
  compared: number; // number of ticks that were compared until now
  difference: { tick: number; joint: string } | null; // the first one
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

// An internal value of a slot, which a change may overwrite.
export interface InternalValue {
  slot: number;
  name: string;
  unit: string;
  scale: number;
  help: string;
  internal: true;
  joints: number[];
  wraps: boolean; // an angle: each number stands for one of -180 to 180 degrees
}

// A parameter of a slot. The arrays have one entry for each joint of `joints`.
export interface Parameter extends Omit<InternalValue, 'internal'> {
  internal: false;
  minimum: number; // raw, as the values below
  maximum: number;
  useful?: [number, number]; // the range that most users need; missing: from minimum to maximum
  default: number;
  file: number[];
  wanted: number[];
  confirmed: number[];
  tick: number[]; // tick from which the confirmed value holds
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

// A shape of an object of the draft's world.
export interface WorldShape {
  type: 'box' | 'sphere' | 'cylinder' | 'trimesh' | 'heightfield';
  size: number[]; // metres; box: sides; sphere: radius; cylinder: radius, height; height field: sides
  friction: number | null; // null: that of what it touches holds
  colour: [number, number, number] | null; // red, green, blue, 0 to 1
}

export interface WorldObject {
  name: string;
  file: string; // where it is
  line: number;
  editable: boolean; // false: it is in a file of its own
  group: number | null; // objects of a group have the same number
  group_size: number;
  moves: boolean;
  index: number; // in `objects` of `draft_robot` if it moves, else in `terrain`
  mass: number | null; // kilograms, of one that moves
  pose: PoseArray; // in the world
  shapes: WorldShape[];
}

export interface WorldDocument {
  file: string;
  objects: WorldObject[];
  rulers: { from: [number, number, number]; to: [number, number, number] }[];
  start: { position: [number, number, number]; degrees: [number, number, number] }; // degrees about x, then y, then z
}

// How the draft is run.
export interface RunDocument {
  duration: number; // seconds
  seed: string; // numbers of JSON do not have all seeds
  tick: number; // milliseconds
  step: number; // milliseconds
  solver: 'automatic' | 'direct' | 'iterative';
  contact_noise: number; // 0 to 1
  engine: 'ode' | 'reduced' | 'mujoco';
  gravity: [number, number, number]; // m/s^2
  self_collision: boolean;
}

// The scenario that viewers make.
export interface DraftDocument {
  file: string;
  revision: number;
  layout: number; // operations of the world have it: their positions in lists are of this layout
  undo: string | null;
  redo: string | null;
  changed: string[]; // files that differ from the disk
  has_file: boolean;
  unsaved: { time_ms: number; files: string[] } | null; // changes that an earlier program did not save
  is_shipped: boolean; // the files ship with Proleg: only a copy can be saved
  warnings: string[];
  head: PoseArray; // of the robot, at the start
  robot: DraftRobot;
  behaviour: BehaviourDocument;
  run: RunDocument;
  world: WorldDocument;
}

export interface DraftJoint {
  name: string;
  editable: boolean; // it is in the robot's file
  axis: [number, number, number]; // as in the file: 1 0 0 is pitch, 0 0 1 yaw
  limits: [number, number]; // degrees
  torque: number; // Nm
  speed: number; // rad/s
}

export interface DraftLink {
  name: string;
  file: string;
  same: number; // links that have the same <Body>, and change with it
  mass: number; // kg
  friction: number | null;
}

export interface DraftSensor {
  name: string;
  kind: string;
  part: number; // number of its link, or of its joint
  part_name: string;
  pose: PoseArray; // in the frame of its link
  extents?: [number, number, number] | null; // of a TactileSensor, metres
  input?: 'front' | 'rear' | null;
  minangle?: number; // of a laser, degrees
  maxangle?: number;
  resolution?: number;
  maxrange?: number; // metres
  scantime?: number; // seconds
}

export interface ServoDocument {
  gain: number; // 1/s
  period: number; // ms
  command_speed: number; // degrees/s
  latency: number; // ms
}

// Joints and links from the head.
export interface DraftRobot {
  file: string;
  name: string;
  joints: DraftJoint[];
  links: DraftLink[];
  sensors: DraftSensor[];
  servo: ServoDocument;
  obstacle: string | null; // why links cannot be added or removed
}

export interface BehaviourModule {
  algorithm: string;
  joints: number[]; // that it moves, in kernel order
  values: Record<string, number[]>; // of each parameter, raw, for each of its joints
}

export interface BehaviourDocument {
  file: string;
  modules: BehaviourModule[];
}

export interface RobotKind {
  name: string;
  help: string;
  axes: string; // from the tail, repeated: p (pitch), y (yaw)
  joints: number;
}

// What a robot can get.
export interface PartsDocument {
  kinds: RobotKind[];
  sensors: { kind: string; help: string; at_joint: boolean }[];
  places: string[]; // of sensors on a link
  most_joints: number;
  most_modules: number;
}

// A parameter as its declaration has it.
export type AlgorithmParameter = Pick<Parameter, 'name' | 'unit' | 'scale' | 'wraps' | 'minimum' | 'maximum' | 'useful' | 'default' | 'help'>;

// What an actuation module can do.
export interface AlgorithmDocument {
  name: string;
  id: number;
  help: string;
  own: boolean; // of a user, not built in
  touch: boolean; // it uses the touch sensors
  broadcasts: boolean;
  parameters: AlgorithmParameter[];
}

export interface LibraryParameter {
  name: string;
  help: string;
  unit: string;
  lowest: number;
  highest: number;
  usual: number;
  whole: boolean;
}

export interface LibraryItem {
  name: string;
  help: string;
  parameters: LibraryParameter[];
}

// Where the robot of the draft will be.
export interface ForesightDocument {
  revision: number; // of the draft
  engine: string;
  seconds: number;
  path: [number, number, number][]; // of the head's frame, a point each 0.1 s
  distance: number | null; // metres
  heading: number | null; // degrees
  failure: string | null;
  servo_problem: string | null;
}

// A picture of a scenario, 1000 wide and 500 high, y downwards. Lines are x, y, x, y, ...; a side of a solid begins with its
// light, 0 to 4.
export interface GalleryPicture {
  view: 'side' | 'above';
  step: number; // metres between two lines on the ground
  thickness: number; // of the robot
  ground: number[][]; // sections from the back to the front
  lines: number[][]; // on the ground, across
  objects: number[][]; // sides of what moves
  path: number[]; // of the head, on the ground
  ghosts: number[][]; // the robot earlier in the stride
  shadow: number[];
  body: number[]; // from the head to the tail
  links: [number, ...number[][]][]; // 1: the head; then its sides; empty: the body is all that is drawn
}

// A scenario that can be opened.
export interface GalleryEntry {
  file: string;
  folder: string; // the heading under which it stands
  title: string;
  text: string; // a sentence, or nothing
  joints: number | null; // null until the file has been read
  algorithms: string[];
  distance: number | null; // metres in 10 s
  is_shipped: boolean;
  failure: string | null; // why it cannot be opened
  picture: GalleryPicture | null;
}

export type UnitName = 'degree' | 'phase_degree' | 'hertz' | 'per_second' | 'ratio' | 'count';

export interface FormParameter {
  name: string;
  unit: UnitName;
  minimum: string; // decimal numbers
  default: string;
  maximum: string;
  help: string;
}

export interface FormValue {
  name: string;
  unit: UnitName;
  help: string;
}

export interface AlgorithmForm {
  name: string;
  id: number;
  help: string;
  parameters: FormParameter[];
  values: FormValue[];
  touch: boolean;
}

// The algorithms of users' own in the folder of the project.
export interface AlgorithmFolders {
  refusal: string | null; // the reason why none can be written
  folders: { folder: string; name: string; library: string; loaded: boolean }[];
  form: AlgorithmForm; // of a new one
}

export interface BuildMessage {
  file: string;
  line: number; // 0: none
  column: number;
  severity: 'error' | 'warning' | 'note';
  text: string;
}

interface AlgorithmWork {
  folder: string;
  name: string;
  version: string; // of the source
  state: 'running' | 'passed' | 'failed' | 'cancelled';
  error: string | null;
}

export interface AlgorithmBuild extends AlgorithmWork {
  done: number;
  of: number; // 0: not known yet
  messages: BuildMessage[];
}

export interface AlgorithmCheck extends AlgorithmWork {
  lines: string[];
}

// The value of `algorithm.read`.
export interface AlgorithmSource {
  name: string;
  file: string;
  text: string;
  version: string;
}

export interface Documents {
  gallery: { entries: GalleryEntry[] };
  algorithm_folders: AlgorithmFolders;
  algorithm_build: AlgorithmBuild;
  algorithm_check: AlgorithmCheck;
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
  bus: BusDocument;
  control: ControlDocument;
  telemetry: TelemetryDocument;
  remote: RemoteDocument;
  remote_values: RemoteValues;
  recordings: RecordingsDocument;
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

// The value of `draft.diff`.
export interface DraftDiff {
  files: { name: string; is_shipped: boolean; old: string | null; new: string | null }[];
}

// What all operations have that name parts of the draft by their positions.
export interface PartOperation {
  layout: number;
  gesture?: number; // operations with the same number are one entry of undo
}

// What a new scenario begins with. What is missing is as usual.
export interface NewScenario {
  kind?: string;
  axes?: string; // for each joint from the tail: p or y
  name?: string;
  algorithm?: string;
  item?: string; // of the library, in front of the robot
  values?: Record<string, number>;
  friction?: number; // of the ground
  discard?: boolean; // the changes of a draft without files
}

export interface Operations {
  'algorithm.refresh': Record<string, never>;
  'algorithm.read': { folder: string };
  'algorithm.create': AlgorithmForm;
  'algorithm.save': { folder: string; version: string; text: string; part: number; more: boolean };
  'algorithm.build': { folder: string };
  'algorithm.check': { folder: string };
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
  'world.remove': PartOperation & { object: number; group?: boolean };
  'world.duplicate': PartOperation & { object: number; group?: boolean; step: [number, number, number]; count: number };
  'world.add': PartOperation & { item: string; values: Record<string, number>; position: [number, number, number]; turn: number };
  'world.start': PartOperation & { position: [number, number, number]; degrees: [number, number, number] };
  'world.ruler': PartOperation & { ruler?: number; from: [number, number, number]; to: [number, number, number] };
  'world.remove_ruler': PartOperation & { ruler: number };
  'robot.axis': PartOperation & { joints: readonly number[]; value: readonly [number, number, number] };
  'robot.limits': PartOperation & { joints: readonly number[]; lower: number; upper: number };
  'robot.torque': PartOperation & { joints: readonly number[]; value: number };
  'robot.speed': PartOperation & { joints: readonly number[]; value: number };
  'robot.rename_joint': PartOperation & { joint: number; name: string };
  'robot.rename': PartOperation & { name: string };
  'robot.servo': PartOperation & { name: keyof ServoDocument; value: number };
  'robot.mass': PartOperation & { link: number; value: number };
  'robot.friction': PartOperation & { link: number; value: number | null };
  'robot.duplicate': PartOperation & { joint: number };
  'robot.remove': PartOperation & { joint: number };
  'robot.count': PartOperation & { value: number };
  'robot.order': PartOperation & { order: readonly number[] };
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
