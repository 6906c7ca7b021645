// Mouse, touch and keys of the 3D view.
//   drag, one finger: turn      right or Shift and drag, two fingers: pan      wheel, pinch: zoom
import type { ToScene } from '../scene/scene_messages.js';

interface Point {
  x: number;
  y: number;
}

const keyStep = 24; // pixels
const wheelFactor = 0.0012; // for each pixel

export function listenToPointer(canvas: HTMLCanvasElement, send: (message: ToScene) => void, leave: () => void): () => void {
  const pointers = new Map<number, Point>();
  let isPanning = false;
  const abort = new AbortController();
  const options = { signal: abort.signal };

  canvas.addEventListener(
    'pointerdown',
    (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
      isPanning = event.button !== 0 || event.shiftKey;
    },
    options,
  );
  canvas.addEventListener(
    'pointermove',
    (event) => {
      const before = pointers.get(event.pointerId);
      if (before === undefined) {
        send(pointedAt(canvas, event));
        return;
      }
      const now = { x: event.clientX, y: event.clientY };
      const right = now.x - before.x;
      const down = now.y - before.y;
      if (pointers.size === 2) {
        const other = [...pointers].find(([id]) => id !== event.pointerId)?.[1] as Point;
        send({ kind: 'zoom', factor: distance(before, other) / Math.max(1, distance(now, other)) });
        send({ kind: 'pan', right: right / 2, down: down / 2 });
      } else {
        send({ kind: isPanning ? 'pan' : 'turn', right, down });
      }
      pointers.set(event.pointerId, now);
    },
    options,
  );
  const release = (event: PointerEvent) => void pointers.delete(event.pointerId);
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

function pointedAt(canvas: HTMLCanvasElement, event: PointerEvent): ToScene {
  const box = canvas.getBoundingClientRect();
  return {
    kind: 'point',
    x: ((event.clientX - box.left) / box.width) * 2 - 1,
    y: 1 - ((event.clientY - box.top) / box.height) * 2,
  };
}

function distance(a: Point, b: Point): number {
  return Math.hypot(a.x - b.x, a.y - b.y);
}
