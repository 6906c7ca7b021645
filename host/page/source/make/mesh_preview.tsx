// A mesh in 3D as it will stand: turned by a drag, or by the arrow keys.
import { useSignal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import type { Vector } from '../geometry/quaternion.js';
import { drawShape, projection, quarterTurns, type Camera, type MeshShape } from './mesh_shape.js';

const size = { width: 320, height: 220 };
const margin = 0.36; // of the picture, for half of the mesh
const keyTurn = 0.2; // radians

interface Preview {
  shape: MeshShape;
  lowest: Vector;
  highest: Vector;
  quarters: readonly [number, number, number];
  colour: Vector;
  axisTexts: readonly [string, string, string];
}

export function MeshPreview({ shape, lowest, highest, quarters, colour, axisTexts }: Preview) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const camera = useSignal<Camera>({ yaw: 0.6, pitch: 0.45 });
  const pressed = useRef<{ x: number; y: number } | null>(null);
  const turn = (yaw: number, pitch: number) => {
    const { yaw: y, pitch: p } = camera.peek();
    camera.value = { yaw: y + yaw, pitch: Math.min(1.5, Math.max(-1.5, p + pitch)) };
  };

  useEffect(() => {
    const context = canvas.current?.getContext('2d');
    if (context == null) return;
    const middle: Vector = [(lowest[0] + highest[0]) / 2, (lowest[1] + highest[1]) / 2, (lowest[2] + highest[2]) / 2];
    const half = Math.hypot(highest[0] - lowest[0], highest[1] - lowest[1], highest[2] - lowest[2]) / 2;
    const scale = (margin * size.height) / half;
    const image = new ImageData(size.width, size.height);
    drawShape(image, shape, quarterTurns(quarters), middle, scale, camera.value, colour);
    context.putImageData(image, 0, 0);
    const style = getComputedStyle(canvas.current!);
    context.strokeStyle = style.color;
    context.fillStyle = style.color;
    context.font = '12px sans-serif';
    const seen = projection(camera.value);
    const origin: [number, number] = [36, size.height - 30];
    const length = 24; // pixels
    for (const [axis, text] of axisTexts.entries()) {
      const [x, y] = seen([axis === 0 ? length : 0, axis === 1 ? length : 0, axis === 2 ? length : 0]);
      context.beginPath();
      context.moveTo(...origin);
      context.lineTo(origin[0] + x, origin[1] + y);
      context.stroke();
      context.fillText(text, Math.max(2, origin[0] + 1.25 * x - 3), origin[1] + 1.25 * y + 4);
    }
  }, [shape, quarters.join(), colour.join(), camera.value]);

  return (
    <canvas
      ref={canvas}
      class="mesh-preview"
      width={size.width}
      height={size.height}
      tabIndex={0}
      role="img"
      aria-label="The mesh as it will stand. Arrow keys turn the view."
      data-testid="mesh-preview"
      onPointerDown={(event) => {
        pressed.current = { x: event.clientX, y: event.clientY };
        event.currentTarget.setPointerCapture(event.pointerId);
      }}
      onPointerMove={(event) => {
        const from = pressed.current;
        if (from === null) return;
        turn((from.x - event.clientX) / 80, (event.clientY - from.y) / 80);
        pressed.current = { x: event.clientX, y: event.clientY };
      }}
      onPointerUp={() => (pressed.current = null)}
      onPointerCancel={() => (pressed.current = null)}
      onKeyDown={(event) => {
        const yaw = event.key === 'ArrowLeft' ? -keyTurn : event.key === 'ArrowRight' ? keyTurn : 0;
        const pitch = event.key === 'ArrowUp' ? keyTurn : event.key === 'ArrowDown' ? -keyTurn : 0;
        if (yaw === 0 && pitch === 0) return;
        event.preventDefault();
        event.stopPropagation();
        turn(yaw, pitch);
      }}
    />
  );
}
