// The rows of the table of modules: what is live on the bus, what the last scan has found, and whose joint it is.
import type { BusModule, ModulesDocument, PlacedJoint, ScannedNode } from '../wire/messages.js';

export interface ModuleRow {
  node: number;
  serial: number | null;
  joint: PlacedJoint | null; // of the robot, by the node id
  isOtherModule: boolean; // the robot's file names a module with another serial number for this joint
  touch: number | null; // bits of the sensors; null: not known
  hasFrontSensors: boolean; // the link in front of the joint has no module of its own: it is the head
  live: BusModule | null;
  found: ScannedNode | null;
}

const frontSensors = 0b1100;

// What of the live modules is known while a job has the bus: a module that nobody asks is not silent, and its sensors are not read.
export interface Watch {
  knowsSilence: boolean;
  readsTouch: boolean;
}

export function moduleRows(
  live: readonly BusModule[],
  modules: Pick<ModulesDocument, 'found' | 'robot'>,
  watch: Watch = { knowsSilence: true, readsTouch: true },
): ModuleRow[] {
  const found = modules.found?.nodes ?? [];
  const joints = modules.robot?.joints ?? [];
  const nodes = [...new Set([...live, ...found].map(({ node }) => node))].sort((a, b) => a - b);
  return nodes.map((node) => {
    const known = live.find((candidate) => candidate.node === node) ?? null;
    const module = known === null ? null : { ...known, silent: known.silent && watch.knowsSilence };
    const scanned = found.find((candidate) => candidate.node === node) ?? null;
    const place = joints.findIndex((candidate) => candidate.node === node);
    const joint = joints[place] ?? null;
    const serial = scanned?.serial ?? null;
    const touch = watch.readsTouch ? (module?.contacts ?? null) : null;
    return {
      node,
      serial,
      joint,
      isOtherModule: joint !== null && joint.serial !== null && serial !== null && joint.serial !== serial,
      touch,
      hasFrontSensors: place === 0 || ((touch ?? 0) & frontSensors) !== 0,
      live: module,
      found: scanned,
    };
  });
}

// Whether modules without a node id are on the bus.
export function hasFreshModules({ found }: Pick<ModulesDocument, 'found'>): boolean {
  return found?.fresh_modules ?? found?.modules_without_node_id ?? false;
}

export function serialText(serial: number | null): string {
  return serial === null ? '–' : `0x${serial.toString(16).toUpperCase().padStart(8, '0')}`;
}

// A module as people name it: by its node id, or without one by its serial number.
export function refText({ node, serial }: { node: number; serial: number | null }): string {
  return node === 0 ? `the module ${serialText(serial)}` : `node ${node}`;
}

// "1,3": as the programs take it.
export function nodeList(nodes: Iterable<number>): string {
  return [...nodes].sort((a, b) => a - b).join(',');
}
