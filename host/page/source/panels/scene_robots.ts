// The robot of the 3D view, the ghost beside it and the paths of both, sent to the worker whenever one of them changes.
import { effect } from '@preact/signals-core';
import type { ToScene } from '../scene/scene_messages.js';
import type { RobotView } from '../view/robot_view.js';
import type { RobotDocument } from '../wire/messages.js';

// With the robot the worker forgets the ghost and both paths: they follow it. Returns the function that ends it.
export function sendRobots(app: Pick<RobotView, 'compared' | 'state' | 'wholePath'>, send: (message: ToScene) => void): () => void {
  let lastRobot: RobotDocument | null = null;
  let lastGhost: RobotDocument | null = null;
  let lastHeads: Float64Array | null = null;
  let lastGhostHeads: Float64Array | null = null;
  return effect(() => {
    const robot = app.state.robot.value;
    const heads = app.wholePath.value;
    const compared = app.compared?.value?.reader ?? null;
    const ghost = compared?.robot ?? robot;
    const ghostHeads = compared?.wholePath.value ?? null;
    if (robot === null) return;
    const isNew = robot !== lastRobot;
    if (isNew) send({ kind: 'robot', robot });
    if (heads !== null && (isNew || heads !== lastHeads)) send({ kind: 'path', heads, isOfGhost: false });
    const isOtherGhost = ghost !== (isNew ? robot : lastGhost);
    if (isOtherGhost && ghost !== null) send({ kind: 'ghost', robot: ghost });
    if (ghostHeads !== null && (isNew || isOtherGhost || ghostHeads !== lastGhostHeads)) send({ kind: 'path', heads: ghostHeads, isOfGhost: true });
    if (ghostHeads === null && lastGhostHeads !== null) send({ kind: 'path', heads: new Float64Array(), isOfGhost: true });
    [lastRobot, lastGhost, lastHeads, lastGhostHeads] = [robot, ghost, heads, ghostHeads];
  });
}
