// The worker that draws the 3D view, so that drawing never holds up a slider or STOP.
import { RobotScene } from './robot_scene.js';
import type { FromScene, ToScene } from './scene_messages.js';

const post = (message: FromScene) => self.postMessage(message);

let scene: RobotScene | null = null;

function start(canvas: OffscreenCanvas, isDark: boolean): void {
  try {
    scene = new RobotScene(canvas, isDark);
  } catch (error) {
    post({ kind: 'failed', reason: (error as Error).message });
    return;
  }
  const draw = () => {
    scene?.render();
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
    case 'pose':
      return view.setPose(message.pose);
    case 'path':
      return view.setPath(message.heads);
    case 'theme':
      return view.setTheme(message.isDark);
    case 'highlight':
      return view.highlight(message.joint);
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
