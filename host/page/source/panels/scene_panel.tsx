// The 3D view: a canvas on which a worker draws, and its reactions to pointer and keys.
import { effect, useSignal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import { limitFrameRate, onFrame } from '../view/frame_clock.js';
import type { RobotView } from '../view/robot_view.js';
import { setPictureSource } from '../scene/canvas_picture.js';
import type { FromScene, ScenePose, ToScene } from '../scene/scene_messages.js';
import { ghostIsOn, toggleGhost } from '../view/robot_actions.js';
import type { MoveTool } from '../state/move_tool.js';
import { isDark } from '../view/theme.js';
import { MoveForm } from './move_form.js';
import { listenToPointer, type RobotMover } from './scene_pointer.js';
import { ScenePull } from './scene_pull.js';
import { areComing } from './joint_values.js';
import { poseAt, shownPose } from './scene_pose.js';
import { sendRobots } from './scene_robots.js';

const readoutPeriod = 100; // milliseconds

// What a person can do about a 3D view that does not start.
function remedy(reason: string): string {
  return /webgl|offscreen/i.test(reason)
    ? "The browser has no WebGL: switch hardware acceleration on in the browser's settings, or try another browser. All other panels work without it."
    : '';
}

// What keys do with the view that shows a robot now: a page may close its view and open another one.
const views = new WeakMap<RobotView, { follow(): void; reset(): void }>();

// `problem`: why the robot does not move as it should; null: it does.
export function ScenePanel({ app, problem = null }: { app: RobotView; problem?: string | null }) {
  const holder = useRef<HTMLDivElement>(null);
  const readout = useRef<HTMLSpanElement>(null);
  const isFollowing = useSignal(true);
  const level = useSignal(0);
  const failure = useSignal<string | null>(null);
  const isOnBus = app.state.busSession.value !== null;
  const compared = app.compared?.value ?? null;
  const post = useRef<(message: ToScene) => void>(() => {});

  useEffect(() => {
    const parent = holder.current as HTMLDivElement;
    // A canvas can be given to a worker only once, so each mount has its own.
    const canvas = document.createElement('canvas');
    canvas.tabIndex = 0;
    canvas.setAttribute('role', 'img');
    canvas.setAttribute('data-arrows', '');
    canvas.setAttribute('data-testid', 'scene');
    canvas.setAttribute('aria-label', 'The robot in 3D. Arrow keys turn the view, plus and minus zoom.');
    parent.append(canvas);
    let worker: Worker;
    let offscreen: OffscreenCanvas;
    try {
      worker = app.startSceneWorker();
      offscreen = canvas.transferControlToOffscreen();
    } catch (error) {
      failure.value = (error as Error).message;
      return () => canvas.remove();
    }
    const pictures: { done: (picture: ImageBitmap) => void; failed: (error: Error) => void }[] = [];
    const fail = (reason: string) => {
      failure.value = reason;
      pictures.splice(0).forEach(({ failed }) => failed(new Error(reason)));
    };
    worker.onerror = (event) => fail(event.message || 'the browser starts no worker');
    const send = (message: ToScene, transfer: Transferable[] = []) => worker.postMessage(message, transfer);
    post.current = send;
    const pull = new ScenePull(app, send);
    worker.onmessage = (event: MessageEvent<FromScene>) => {
      const message = event.data;
      if (message.kind === 'pointed') app.selection.hoveredJoint.value = message.joint;
      if (message.kind === 'chosen') app.choice?.choose(message.joint, message.object, message.adds);
      if (message.kind === 'grabbed_robot') app.mover?.begin();
      if (message.kind === 'dragged_robot') app.mover?.drag(message.offset, message.turn);
      if (message.kind === 'dropped_robot') void app.mover?.drop();
      if (message.kind === 'grabbed_joint') pull.grabbed(message.joint);
      if (message.kind === 'dragged_joint') pull.dragged(message.angle);
      if (message.kind === 'following') isFollowing.value = message.isOn;
      if (message.kind === 'detail') {
        level.value = message.level;
        limitFrameRate(message.level > 0);
      }
      if (message.kind === 'picture') {
        const asked = pictures.shift();
        if (message.picture === null) asked?.failed(new Error('the browser makes no picture'));
        else asked?.done(message.picture);
      }
      if (message.kind === 'failed') fail(message.reason);
    };
    const mover: RobotMover = {
      isActive: () => app.mover?.isActive.peek() ?? false,
    };
    const choose = app.choice === undefined ? null : (x: number, y: number, adds: boolean) => send({ kind: 'choose', x, y, adds });
    send({ kind: 'start', canvas: offscreen, isDark: isDark.peek() }, [offscreen]);
    setPictureSource(canvas, () => {
      const reason = failure.peek();
      if (reason !== null) return Promise.reject(new Error(reason));
      send({ kind: 'picture' });
      return new Promise((done, failed) => pictures.push({ done, failed }));
    });
    const observer = new ResizeObserver(([entry]) => {
      const { width, height } = (entry as ResizeObserverEntry).contentRect;
      send({ kind: 'size', width, height, ratio: window.devicePixelRatio });
    });
    observer.observe(parent);
    const stops = [
      listenToPointer(canvas, send, () => (app.selection.hoveredJoint.value = null), mover, pull, choose),
      effect(() => void canvas.classList.toggle('can-pull', pull.isPossible)),
      effect(() => send({ kind: 'theme', isDark: isDark.value })),
      sendRobots(app, send),
      effect(() => {
        const hovered = app.selection.hoveredJoint.value;
        const chosen = app.choice?.joints.value ?? [];
        send({ kind: 'highlight', joints: hovered === null ? chosen : [...chosen, hovered], objects: app.choice?.objects.value ?? [] });
      }),
      followPose(app, send, readout),
    ];
    views.set(app, {
      follow: () => send({ kind: 'follow', isOn: !isFollowing.peek() }),
      reset: () => send({ kind: 'reset_view' }),
    });
    app.actions.find('follow') ??
      app.actions.add(
        {
          id: 'follow',
          title: '3D view: follow the robot, or stay',
          group: 'View',
          keys: ['F'],
          run: () => views.get(app)?.follow(),
        },
        {
          id: 'reset_view',
          title: '3D view: back to the start',
          group: 'View',
          keys: ['H'],
          run: () => views.get(app)?.reset(),
        },
      );
    return () => {
      stops.forEach((stop) => stop());
      observer.disconnect();
      worker.terminate();
      pictures.splice(0).forEach(({ failed }) => failed(new Error('the 3D view was closed')));
      canvas.remove();
    };
  }, []);

  return (
    <section class="panel scene-panel" aria-label="Robot in 3D">
      <div class="scene" ref={holder} data-detail={level.value} />
      <div class="scene-tools">
        {app.mover !== null && !isOnBus && <MoveButton mover={app.mover} />}
        <button
          type="button"
          aria-pressed={isFollowing.value}
          onClick={() => post.current({ kind: 'follow', isOn: !isFollowing.value })}
          title="The view goes with the robot (F)"
        >
          Follow
        </button>
        {isOnBus && (
          <button
            type="button"
            aria-pressed={ghostIsOn.value}
            onClick={toggleGhost}
            title="Also shows the simulation that runs beside the robot, translucent (Shift + G)"
          >
            Ghost
          </button>
        )}
        <button type="button" onClick={() => post.current({ kind: 'reset_view' })} title="Back to the first view (H)">
          Reset view
        </button>
      </div>
      {app.mover?.isActive.value === true && <MoveForm mover={app.mover} />}
      <span class="readout" ref={readout} data-testid="head" title="Position of the head" />
      <span class="legend-marks" aria-hidden="true">
        <i class="mark head" /> head <i class="mark contact" /> ground contact <i class="mark path" /> path
        {((isOnBus && ghostIsOn.value) || compared !== null) && (
          <>
            {' '}
            <i class="mark ghost" /> {compared === null ? 'simulation' : (compared.legend ?? 'second recording')}
          </>
        )}
      </span>
      {problem !== null && (
        // In front of the picture, where it moves no control: a second click must be where the first one was.
        <p class="scene-problem" role="status" data-testid="servo-problem">
          {problem}
        </p>
      )}
      {level.value > 0 && (
        <span class="detail-note" title="The controls come first.">
          less detail: this computer draws slowly
        </span>
      )}
      {failure.value !== null && <p class="scene-failure">No 3D view: {failure.value} {remedy(failure.value)}</p>}
    </section>
  );
}

function MoveButton({ mover }: { mover: MoveTool }) {
  return (
    <button
      type="button"
      aria-pressed={mover.isActive.value}
      disabled={!mover.isPossible.value}
      onClick={() => (mover.isOn.value = !mover.isOn.value)}
      title="Drag the paused robot to another place (G)"
    >
      Move
    </button>
  );
}

// The text has no sign for -0.000.
function positionText(name: string, head: Float64Array): string {
  const [x, y, z] = [...head.subarray(0, 3)].map((metres) => (Math.round(metres * 1000) / 1000 + 0).toFixed(3));
  return `${name}  x ${x}  y ${y}  z ${z} m`;
}

// Sends the pose at the time cursor whenever it changed, and writes where the head is.
function followPose(app: RobotView, send: (message: ToScene) => void, readout: { current: HTMLSpanElement | null }): () => void {
  let lastKey = '';
  let robot: unknown = null;
  let session: unknown = null;
  let preview: unknown = null;
  let withGhost = false;
  let compared: unknown = null;
  let unwritten: ScenePose | null = null; // pose whose head is not written yet
  let lastReadout = 0;
  const sendChangedPose = () => {
    const { rowsAtCursor: history, time, mover } = app;
    const tick = time.shownTick(app.newestTick);
    const other = app.compared?.peek()?.reader;
    const key = [history.run, history.end, tick, other?.rowsAtCursor.run, other?.rowsAtCursor.end].join('/');
    const isSame =
      compared === other &&
      robot === app.state.robot.peek() &&
      session === mover?.session.peek() &&
      preview === mover?.preview.peek() &&
      withGhost === ghostIsOn.peek();
    if ((key === lastKey && isSame) || areComing(app, tick)) {
      return;
    }
    const pose = shownPose(app, tick, ghostIsOn.peek());
    if (pose === null || app.state.robot.peek() === null) {
      return;
    }
    if (other?.has(tick) === true) {
      const { angles, head } = poseAt(other.rowsAtCursor, tick, false, false) ?? { angles: null, head: null };
      Object.assign(pose, { ghost: angles, ghostHead: head });
    }
    lastKey = key;
    compared = other;
    robot = app.state.robot.peek();
    session = mover?.session.peek();
    preview = mover?.preview.peek();
    withGhost = ghostIsOn.peek();
    unwritten = pose;
    send({ kind: 'pose', pose });
  };
  return onFrame((now) => {
    sendChangedPose();
    if (unwritten !== null && readout.current !== null && now - lastReadout > readoutPeriod) {
      // A bus does not report the place of a robot: the view shows the place of its simulation.
      const name = app.state.busSession.peek() === null ? 'head' : 'simulated head';
      readout.current.textContent = unwritten.head === null ? '' : positionText(name, unwritten.head);
      lastReadout = now;
      unwritten = null;
    }
  });
}
