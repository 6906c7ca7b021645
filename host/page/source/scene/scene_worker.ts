// The worker that draws the 3D view, so that drawing never holds up a slider or STOP.
import { DrawingBudget, slowFrame, slowFrameInSoftware } from './drawing_budget.js';
import { RobotScene } from './robot_scene.js';
import type { FromScene, ToScene } from './scene_messages.js';

const post = (message: FromScene, transfer: Transferable[] = []) => self.postMessage(message, { transfer });

let scene: RobotScene | null = null;

// Whether WebGL has no graphics processor behind it.
function isDrawnInSoftware(): boolean {
  const context = new OffscreenCanvas(1, 1).getContext('webgl2');
  const extension = context?.getExtension('WEBGL_debug_renderer_info');
  const name = extension ? String(context?.getParameter(extension.UNMASKED_RENDERER_WEBGL)) : '';
  context?.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software/i.test(name);
}

function start(canvas: OffscreenCanvas, isDark: boolean): void {
  const isSoftware = isDrawnInSoftware();
  const budget = isSoftware ? new DrawingBudget(1, slowFrameInSoftware) : new DrawingBudget(0, slowFrame);
  let view: RobotScene;
  try {
    view = new RobotScene(canvas, isDark, isSoftware, budget.detail);
  } catch (error) {
    post({ kind: 'failed', reason: (error as Error).message });
    return;
  }
  scene = view;
  post({ kind: 'detail', level: budget.level });
  const draw = (now: number) => {
    if (budget.note(now, view.render())) {
      view.setDetail(budget.detail);
      post({ kind: 'detail', level: budget.level });
    }
    requestAnimationFrame(draw);
  };
  requestAnimationFrame(draw);
}

function apply(view: RobotScene, message: Exclude<ToScene, { kind: 'start' }>): void {
  switch (message.kind) {
    case 'size':
      return view.setSize(message.width, message.height, message.ratio);
    case 'robot':
      return view.setRobot(message.robot);
    case 'ghost':
      return view.setGhost(message.robot);
    case 'pose':
      return view.setPose(message.pose);
    case 'path':
      return view.setPath(message.heads, message.isOfGhost);
    case 'theme':
      return view.setTheme(message.isDark);
    case 'highlight':
      return view.highlight(message.joints, message.objects);
    case 'turn':
      return view.turn(message.right, message.down);
    case 'pan':
      return view.pan(message.right, message.down);
    case 'zoom':
      return view.zoom(message.factor);
    case 'follow':
      return view.setFollowing(message.isOn);
    case 'reset_view':
      return view.resetView();
    case 'picture':
      view.picture().then(
        (picture) => post({ kind: 'picture', picture }, [picture]),
        () => post({ kind: 'picture', picture: null }),
      );
      return;
    case 'grab_robot':
      if (view.grabRobot(message.x, message.y)) post({ kind: 'grabbed_robot' });
      return;
    case 'drag_robot': {
      const { x, y, right, down, way, turn } = message;
      const offset = view.dragRobot(x, y, way);
      return offset === null ? view.turn(right, down) : post({ kind: 'dragged_robot', offset, turn });
    }
    case 'drop_robot':
      view.dropRobot();
      return post({ kind: 'dropped_robot' });
    case 'grab_joint':
      return post({ kind: 'grabbed_joint', joint: view.grabJoint(message.x, message.y) });
    case 'drag_joint':
      return post({ kind: 'dragged_joint', angle: view.dragJoint(message.x, message.y) });
    case 'choose': {
      const { joint, object } = view.partAt(message.x, message.y);
      return post({ kind: 'chosen', joint, object, adds: message.adds });
    }
    case 'point':
      return post({ kind: 'pointed', joint: view.jointAt(message.x, message.y) });
  }
}

self.onmessage = (event: MessageEvent<ToScene>) => {
  if (event.data.kind === 'start') {
    start(event.data.canvas, event.data.isDark);
  } else if (scene !== null) {
    const wasFollowing = scene.isFollowing;
    apply(scene, event.data);
    if (scene.isFollowing !== wasFollowing) {
      post({ kind: 'following', isOn: scene.isFollowing });
    }
  }
};
