// What the page and the worker of the 3D view say to each other.
import type { RobotDocument } from '../wire/messages.js';

export interface ScenePose {
  angles: Float32Array; // radians
  head: Float64Array; // x, y, z in metres, then the quaternion w, x, y, z
  contacts: Int32Array; // of each link: bit 0 rear, bit 1 front
  run: number;
  isLive: boolean; // only then the path grows
}

export type ToScene =
  | { kind: 'start'; canvas: OffscreenCanvas; isDark: boolean }
  | { kind: 'size'; width: number; height: number; ratio: number } // CSS pixels
  | { kind: 'robot'; robot: RobotDocument }
  | { kind: 'pose'; pose: ScenePose }
  | { kind: 'path'; heads: Float64Array } // the whole path: of each point as `head` of a pose
  | { kind: 'theme'; isDark: boolean }
  | { kind: 'highlight'; joint: number | null }
  | { kind: 'turn'; right: number; down: number } // pixels
  | { kind: 'pan'; right: number; down: number }
  | { kind: 'zoom'; factor: number }
  | { kind: 'follow'; isOn: boolean }
  | { kind: 'reset_view' }
  | { kind: 'point'; x: number; y: number }; // -1 to 1, y up

export type FromScene =
  | { kind: 'pointed'; joint: number | null }
  | { kind: 'following'; isOn: boolean }
  | { kind: 'failed'; reason: string };
