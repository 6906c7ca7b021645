// The messages between the page and the worker of the 3D view.
import type { Vector } from '../geometry/quaternion.js';
import type { RobotDocument } from '../wire/messages.js';

export interface ScenePose {
  angles: Float32Array; // radians
  head: Float64Array | null; // x, y, z in metres, then the quaternion w, x, y, z; null: not known
  ghost: Float32Array | null; // angles of the simulation beside the robot, or of a second recording, radians
  ghostHead?: Float64Array | null; // of the second recording, like `head`; absent: the ghost is where the robot is
  objects?: Float64Array | null; // pose of each object that moves, like `head`; null or absent: their poses at the start
  contacts: Int32Array; // contacts of each link: bit 0 rear, bit 1 front
  run: number;
  isLive: boolean; // only then the path grows
  lastMove: number | null; // tick of the last move by hand before: another one cuts the path
}

// An object around the robot: its position in `objects` of the robot's document if it moves, else in `terrain`.
export interface PlacedObject {
  moves: boolean;
  index: number;
}

// How the pointer moves the robot: over the ground, up and down, or not from its place, because it turns it.
export type DragWay = 'ground' | 'height' | 'none';

export type ToScene =
  | { kind: 'start'; canvas: OffscreenCanvas; isDark: boolean }
  | { kind: 'size'; width: number; height: number; ratio: number } // CSS pixels; device pixels for each of them
  | { kind: 'robot'; robot: RobotDocument }
  | { kind: 'ghost'; robot: RobotDocument } // the ghost is this robot, with a path of its own
  | { kind: 'pose'; pose: ScenePose }
  | { kind: 'path'; heads: Float64Array; isOfGhost: boolean } // the whole path: the values of `head` for each point; NaN: a cut
  | { kind: 'theme'; isDark: boolean }
  | { kind: 'highlight'; joints: readonly number[]; objects: readonly PlacedObject[] }
  | { kind: 'turn'; right: number; down: number } // pixels
  | { kind: 'pan'; right: number; down: number }
  | { kind: 'zoom'; factor: number }
  | { kind: 'follow'; isOn: boolean }
  | { kind: 'reset_view' }
  | { kind: 'picture' } // answered by one; the answers have the order of the requests
  | { kind: 'grab_robot'; x: number; y: number } // place as in `point`; grabs the link there, if there is one
  | { kind: 'drag_robot'; x: number; y: number; right: number; down: number; way: DragWay; turn: number } // turns the view if nothing is grabbed
  | { kind: 'drop_robot' }
  | { kind: 'grab_joint'; x: number; y: number } // place as in `point`; grabs a link, to turn its joint
  | { kind: 'drag_joint'; x: number; y: number }
  | { kind: 'choose'; x: number; y: number; adds: boolean } // place as in `point`; answered by `chosen`
  | { kind: 'point'; x: number; y: number }; // -1 to 1, y up

export type FromScene =
  | { kind: 'grabbed_robot' }
  | { kind: 'dragged_robot'; offset: Vector; turn: number } // metres and degrees since the robot was grabbed
  | { kind: 'dropped_robot' } // sent after all messages of the drag
  | { kind: 'pointed'; joint: number | null }
  | { kind: 'chosen'; joint: number | null; object: PlacedObject | null; adds: boolean } // both null: nothing is there
  | { kind: 'grabbed_joint'; joint: number | null } // null: no joint can be turned from this view
  | { kind: 'dragged_joint'; angle: number } // radians since the grab
  | { kind: 'following'; isOn: boolean }
  | { kind: 'detail'; level: number } // 0: all of it
  | { kind: 'picture'; picture: ImageBitmap | null } // all messages before the request are in it; null: it failed
  | { kind: 'failed'; reason: string };
