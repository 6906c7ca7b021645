// Mouse, touch and keys of the 3D view.
//   click, touch: choose what is there, where that is possible; with Shift or Ctrl in addition
//   drag, one finger: turn the view, or a joint of a robot that is held
//   right or Shift and drag, two fingers: pan      wheel, pinch: zoom
import type { ToScene } from '../scene/scene_messages.js';
import type { ScenePull } from './scene_pull.js';

interface Point {
  x: number;
  y: number;
}

const keyStep = 24; // pixels
const degreesPerPixel = 0.5;
const smallestDrag = 4; // pixels: a click with a trembling hand turns nothing
const wheelFactor = 0.0012; // change of the zoom for each pixel

// Moves the robot with the same pointer instead, while it is active.
//   drag: in the plane of the ground     Shift and drag: height     Ctrl and drag: turn
export interface RobotMover {
  isActive(): boolean;
}

export function listenToPointer(
  canvas: HTMLCanvasElement,
  send: (message: ToScene) => void,
  leave: () => void,
  mover: RobotMover,
  pull: ScenePull,
  choose: ((x: number, y: number, adds: boolean) => void) | null = null, // what a click does
): () => void {
  let moverStart: Point | null = null; // where a drag of the robot began
  let turn = 0; // degrees since the drag began
  const pointers = new Map<number, Point>();
  let isPanning = false;
  let clickStart: Point | null = null; // where a press began that may become a click
  const abort = new AbortController();
  const options = { signal: abort.signal };

  canvas.addEventListener(
    'pointerdown',
    (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
      clickStart = choose !== null && pointers.size === 1 && event.button === 0 ? { x: event.clientX, y: event.clientY } : null;
      isPanning = event.button !== 0 || event.shiftKey;
      const { x, y } = positionIn(canvas, event);
      if (mover.isActive() && event.button === 0 && pointers.size === 1) {
        moverStart = { x: event.clientX, y: event.clientY };
        turn = 0;
        send({ kind: 'grab_robot', x, y });
      } else if (isPanning || pointers.size > 1) {
        pull.release();
      } else {
        pull.press(x, y);
      }
    },
    options,
  );
  canvas.addEventListener(
    'pointermove',
    (event) => {
      const before = pointers.get(event.pointerId);
      if (before === undefined) {
        send({ kind: 'point', ...positionIn(canvas, event) });
        return;
      }
      const now = { x: event.clientX, y: event.clientY };
      if (clickStart !== null && distance(now, clickStart) < smallestDrag) return;
      clickStart = null;
      const right = now.x - before.x;
      const down = now.y - before.y;
      if (moverStart !== null && pointers.size === 1) {
        if (event.ctrlKey) turn = (moverStart.x - now.x) * degreesPerPixel;
        const way = event.ctrlKey ? 'none' : event.shiftKey ? 'height' : 'ground';
        send({ kind: 'drag_robot', ...positionIn(canvas, event), right, down, way, turn });
      } else if (pointers.size === 2) {
        const other = [...pointers].find(([id]) => id !== event.pointerId)?.[1] as Point;
        send({ kind: 'zoom', factor: distance(before, other) / Math.max(1, distance(now, other)) });
        send({ kind: 'pan', right: right / 2, down: down / 2 });
      } else {
        const { x, y } = positionIn(canvas, event);
        if (!pull.move(x, y)) send({ kind: isPanning ? 'pan' : 'turn', right, down });
      }
      pointers.set(event.pointerId, now);
    },
    options,
  );
  const release = (event: PointerEvent) => {
    pointers.delete(event.pointerId);
    pull.release();
    if (clickStart !== null && event.type === 'pointerup') {
      const { x, y } = positionIn(canvas, event);
      choose?.(x, y, event.shiftKey || event.ctrlKey);
    }
    clickStart = null;
    if (moverStart !== null) {
      moverStart = null;
      send({ kind: 'drop_robot' });
    }
  };
  canvas.addEventListener('pointerup', release, options);
  canvas.addEventListener('pointercancel', release, options);
  canvas.addEventListener('pointerleave', leave, options);
  canvas.addEventListener('contextmenu', (event) => event.preventDefault(), options);
  canvas.addEventListener(
    'wheel',
    (event) => {
      event.preventDefault();
      send({ kind: 'zoom', factor: Math.exp(event.deltaY * wheelFactor) });
    },
    { ...options, passive: false },
  );
  canvas.addEventListener('keydown', (event) => turnByKey(event, send), options);
  return () => abort.abort();
}

function turnByKey(event: KeyboardEvent, send: (message: ToScene) => void): void {
  const steps: Record<string, [number, number]> = {
    ArrowLeft: [keyStep, 0],
    ArrowRight: [-keyStep, 0],
    ArrowUp: [0, keyStep],
    ArrowDown: [0, -keyStep],
  };
  const step = steps[event.key];
  if (step !== undefined) {
    send({ kind: event.shiftKey ? 'pan' : 'turn', right: step[0], down: step[1] });
    event.preventDefault();
  } else if (event.key === '+' || event.key === '-') {
    send({ kind: 'zoom', factor: event.key === '+' ? 0.9 : 1.1 });
  }
}

// The place of an event in the view, -1 to 1, y up.
function positionIn(canvas: HTMLCanvasElement, event: PointerEvent): Point {
  const box = canvas.getBoundingClientRect();
  return { x: ((event.clientX - box.left) / box.width) * 2 - 1, y: 1 - ((event.clientY - box.top) / box.height) * 2 };
}

function distance(a: Point, b: Point): number {
  return Math.hypot(a.x - b.x, a.y - b.y);
}
