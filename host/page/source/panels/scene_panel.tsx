// The 3D view: a canvas that a worker draws on, and what pointer and keys do to it.
import { effect, useSignal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import { onFrame } from '../frame_clock.js';
import type { PageApp } from '../page_app.js';
import type { Vector } from '../geometry/quaternion.js';
import type { FromScene, ToScene } from '../scene/scene_messages.js';
import { isDark } from '../theme.js';
import { MoveForm } from './move_form.js';
import { listenToPointer, type RobotMover } from './scene_pointer.js';
import { shownPose } from './scene_pose.js';

const highestRatio = 1.5; // device pixels for each CSS pixel; more costs frames and shows little
const readoutPeriod = 100; // milliseconds

export function ScenePanel({ app }: { app: PageApp }) {
  const holder = useRef<HTMLDivElement>(null);
  const readout = useRef<HTMLSpanElement>(null);
  const isFollowing = useSignal(true);
  const failure = useSignal<string | null>(null);
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
    const worker = new Worker('scene_worker.js');
    const send = (message: ToScene, transfer: Transferable[] = []) => worker.postMessage(message, transfer);
    post.current = send;
    worker.onmessage = (event: MessageEvent<FromScene>) => {
      const message = event.data;
      if (message.kind === 'pointed') app.selection.hoveredJoint.value = message.joint;
      if (message.kind === 'grabbed') app.mover.begin();
      if (message.kind === 'dragged') {
        offset = message.offset;
        app.mover.drag(offset, turn);
      }
      if (message.kind === 'following') isFollowing.value = message.isOn;
      if (message.kind === 'failed') failure.value = message.reason;
    };
    let offset: Vector = [0, 0, 0];
    let turn = 0;
    const mover: RobotMover = {
      isActive: () => app.mover.isActive.peek(),
      turn: (degrees) => {
        turn = degrees;
        app.mover.drag(offset, turn);
      },
      drop: () => {
        offset = [0, 0, 0];
        turn = 0;
        void app.mover.drop();
      },
      step: (way, degrees) => void app.mover.step(way, degrees),
    };
    const offscreen = canvas.transferControlToOffscreen();
    send({ kind: 'start', canvas: offscreen, isDark: isDark.peek() }, [offscreen]);
    const observer = new ResizeObserver(([entry]) => {
      const { width, height } = (entry as ResizeObserverEntry).contentRect;
      send({ kind: 'size', width, height, ratio: Math.min(highestRatio, window.devicePixelRatio) });
    });
    observer.observe(parent);
    const stops = [
      listenToPointer(canvas, send, () => (app.selection.hoveredJoint.value = null), mover),
      effect(() => send({ kind: 'theme', isDark: isDark.value })),
      effect(() => {
        const robot = app.state.robot.value;
        if (robot !== null) send({ kind: 'robot', robot });
      }),
      effect(() => send({ kind: 'highlight', joint: app.selection.hoveredJoint.value })),
      followPose(app, send, readout),
    ];
    app.actions.find('follow') ??
      app.actions.add(
        {
          id: 'follow',
          title: '3D view: follow the robot, or stay',
          group: 'View',
          keys: ['F'],
          run: () => post.current({ kind: 'follow', isOn: !isFollowing.peek() }),
        },
        {
          id: 'reset_view',
          title: '3D view: back to the start',
          group: 'View',
          keys: ['H'],
          run: () => post.current({ kind: 'reset_view' }),
        },
      );
    return () => {
      stops.forEach((stop) => stop());
      observer.disconnect();
      worker.terminate();
      canvas.remove();
    };
  }, []);

  return (
    <section class="panel scene-panel" aria-label="Robot in 3D">
      <div class="scene" ref={holder} />
      <div class="scene-tools">
        <button
          type="button"
          aria-pressed={app.mover.isActive.value}
          disabled={!app.mover.isPossible.value}
          onClick={() => (app.mover.isOn.value = !app.mover.isOn.value)}
          title="Drag the paused robot to another place (G)"
        >
          Move
        </button>
        <button
          type="button"
          aria-pressed={isFollowing.value}
          onClick={() => post.current({ kind: 'follow', isOn: !isFollowing.value })}
          title="The view goes with the robot (F)"
        >
          Follow
        </button>
        <button type="button" onClick={() => post.current({ kind: 'reset_view' })} title="Back to the first view (H)">
          Reset view
        </button>
      </div>
      {app.mover.isActive.value && <MoveForm app={app} />}
      <span class="readout" ref={readout} data-testid="head" title="Position of the head" />
      <span class="legend-marks" aria-hidden="true">
        <i class="mark head" /> head <i class="mark contact" /> ground contact <i class="mark path" /> path
      </span>
      {failure.value !== null && <p class="scene-failure">No 3D view: {failure.value}</p>}
    </section>
  );
}

// Sends the pose at the time cursor whenever it changed, and writes where the head is.
function followPose(app: PageApp, send: (message: ToScene) => void, readout: { current: HTMLSpanElement | null }): () => void {
  let lastKey = '';
  let lastReadout = 0;
  let robot: unknown = null;
  let session: unknown = null;
  let preview: unknown = null;
  let unwritten: Float64Array | null = null; // the head's pose that the readout does not show yet
  return onFrame((now) => {
    const { history, time } = app;
    const tick = time.shownTick(app.newestTick);
    const key = `${history.run}/${history.end}/${tick}`;
    const isSame = robot === app.state.robot.peek() && session === app.state.session.peek() && preview === app.mover.preview.peek();
    if (unwritten !== null && readout.current !== null && now - lastReadout > readoutPeriod) {
      lastReadout = now;
      // Without the sign of -0.000.
      const [x, y, z] = [...unwritten.subarray(0, 3)].map((metres) => (Math.round(metres * 1000) / 1000 + 0).toFixed(3));
      readout.current.textContent = `head  x ${x}  y ${y}  z ${z} m`;
      unwritten = null;
    }
    if (key === lastKey && isSame) {
      return;
    }
    const pose = shownPose(app, tick);
    if (pose === null || app.state.robot.peek() === null) {
      return;
    }
    lastKey = key;
    robot = app.state.robot.peek();
    session = app.state.session.peek();
    preview = app.mover.preview.peek();
    unwritten = pose.head;
    send({ kind: 'pose', pose });
  });
}
