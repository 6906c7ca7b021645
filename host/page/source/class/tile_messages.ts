// What the page of a class and the worker that watches its robots send to each other.
import type { RobotDocument, SimulationSession } from '../wire/messages.js';

// A seat that is watched.
export interface WatchedSeat {
  seat: number;
  url: string;
  token: string;
}

// What a small picture of a robot needs.
export type TileRobot = Pick<RobotDocument, 'joints' | 'links' | 'terrain'>;

export interface TileSession {
  state: SimulationSession['state'] | 'off' | 'starting' | 'held' | 'stopping';
  speed: number | null; // m/s, over the last two strides; null: it does not run, or not yet for so long
  distance: number | null; // metres
  servoProblem: string | null;
  failure: string | null;
  isRecording: boolean;
}

// The robot at one tick.
export interface TileRow {
  run: number;
  tick: number;
  head: number[]; // metres, then the quaternion
  angles: number[]; // radians
}

export interface TileNews {
  seat: number;
  isConnected?: boolean;
  robot?: TileRobot;
  session?: TileSession;
  row?: TileRow;
}

export type ToTileWorker = { kind: 'watch'; seats: WatchedSeat[] } | { kind: 'show'; isShown: boolean };
