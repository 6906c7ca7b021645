// Messages of the page Make: the draft, what can be opened, and algorithms that viewers write (docs/page-interface.md).
import type { Parameter, PoseArray } from './robot_messages.js';

// A shape of an object of the draft's world.
export interface WorldShape {
  type: 'box' | 'sphere' | 'cylinder' | 'trimesh' | 'heightfield';
  size: number[]; // metres; box, mesh: sides; sphere: radius; cylinder: radius, height; height field: sides
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

// New values of a joint; what is missing stays.
export interface JointValues {
  joint: number;
  name?: string;
  axis?: [number, number, number];
  limits?: [number, number]; // degrees, the lower one first
  torque?: number; // Nm
  speed?: number; // rad/s
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
  kinds: { name: string; length: number }[]; // of modules of one's own; metres between two joints
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
  is_complete: boolean; // else it is the first seconds, and the rest follows
  engine: string;
  seconds: number;
  path: [number, number, number][]; // of the head's frame, a point each 0.1 s
  distance: number | null; // metres
  heading: number | null; // degrees
  failure: string | null;
  servo_problem: string | null;
  refusal: string | null; // why the engine that the scenario names does not have such a scenario
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
  missing: string[]; // algorithms that the program lacks
  picture: GalleryPicture | null;
}

// A scenario that could not be read, because the program lacks algorithms.
export interface MissingAlgorithms {
  file: string;
  action: 'start' | 'open' | 'restore'; // what was to be done
  error: string;
  algorithms: { name: string; folder: string | null; library: string | null }[]; // folder: in the project, with its source
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

// The cases as one build has played them.
export interface ProofBuild {
  build: string;
  kernels: number; // 1: one for all joints
  result: 'reference' | 'equal' | 'differs' | 'failed' | 'not run';
  ticks: number; // that were played
  setpoint_hash: string | null;
  servo_hash: string | null;
  text: string | null; // the first difference, the error, or the program that is missing
}

// What `proleg verify --json` prints.
export interface Proof {
  algorithm: string;
  id: number;
  sources: string;
  cases: number;
  ticks: number; // of a case
  verified: boolean;
  builds: ProofBuild[];
  missing: string[]; // programs that are not installed
  test: { name: string; passed: boolean; error: string | null } | null;
  forbidden: string[] | null; // what the code for the modules uses although it may not
  instructions: { worst: number | null; mean: number | null; limit: number; fits: boolean; error: string | null } | null;
  stack: { bytes: number | null; function: string | null; limit: number; fits: boolean } | null;
  flash_bytes: number | null;
}

export interface AlgorithmCheck extends AlgorithmWork {
  done: number; // the step that goes on, from 1
  of: number; // 0: not known yet
  step: string | null;
  proof: Proof | null; // when it has ended
}

// An image for the modules, with algorithms of users.
export interface BuiltImage {
  file: string;
  version: string;
  commit: string | null;
  changed_sources: boolean; // it has more than the commit
  core_fingerprint: string;
  sha256: string;
  flash: number | null; // bytes
  flash_limit: number | null;
  ram: number | null;
  ram_limit: number | null;
  stack: number | null; // at worst
  stack_limit: number | null;
  algorithms: { name: string; sources: string | null }[];
  command: string; // that flashes it
}

// The present or last build of an image.
export interface AlgorithmImage extends Pick<AlgorithmBuild, 'state' | 'error' | 'done' | 'of' | 'messages'> {
  algorithms: { folder: string; name: string }[];
  image: BuiltImage | null; // null: none, or it was not built
}

// The value of `algorithm.read`.
export interface AlgorithmSource {
  name: string;
  file: string;
  text: string;
  version: string;
}

// The value of `draft.diff`.
export interface DraftDiff {
  files: { name: string; is_shipped: boolean; bytes: number; old: string | null; new: string | null }[];
}

// What `mesh.look` says of a mesh that was sent. Lengths are in the unit of its file.
export interface SentMesh {
  mesh: number;
  name: string;
  files: string[]; // the mesh, then those that it names
  triangles: number;
  lowest: [number, number, number]; // corner of the box around it
  highest: [number, number, number];
  gap: string | null; // why its surface is not closed
  flaw: string | null; // why it can be no object of a world
  hull_volume: number | null; // of its convex hull; null: it is flat
  facing: [number, number, number]; // sum of normal times area
  has_colours: boolean;
}

// How a mesh is used.
export interface MeshFit {
  mesh: number;
  factor: number; // metres of its unit
  quarters: readonly [number, number, number]; // turns of 90 degrees about x, then y, then z
  colour: readonly [number, number, number];
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
