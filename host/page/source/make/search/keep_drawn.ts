// A canvas that is drawn again only when what it shows, its size or the theme has changed.
import { effect } from '@preact/signals-core';
import { chartTheme, type ChartTheme } from '../../panels/chart_theme.js';
import { isDark } from '../../view/theme.js';

export interface CanvasSize {
  width: number; // CSS pixels
  height: number;
  ratio: number; // device pixels for each
}

// Draws with the next frame, once for several changes. follow: reads the signals after whose changes it is drawn again.
// Returns the function that ends it.
export function keepDrawn(canvas: HTMLCanvasElement, follow: () => void, draw: (context: CanvasRenderingContext2D, size: CanvasSize, theme: ChartTheme) => void): () => void {
  let { clientWidth: width, clientHeight: height } = canvas;
  let frame = 0;
  const drawNow = () => {
    frame = 0;
    if (width < 100) return;
    const ratio = window.devicePixelRatio;
    // A new size makes the canvas anew, which is expensive.
    const size = { width: Math.round(width * ratio), height: Math.round(height * ratio) };
    if (canvas.width !== size.width || canvas.height !== size.height) Object.assign(canvas, size);
    draw(canvas.getContext('2d') as CanvasRenderingContext2D, { width, height, ratio }, chartTheme(isDark.peek()));
  };
  const drawSoon = () => {
    if (frame === 0) frame = requestAnimationFrame(drawNow);
  };
  const observer = new ResizeObserver(([entry]) => {
    ({ width, height } = (entry as ResizeObserverEntry).contentRect);
    drawSoon();
  });
  observer.observe(canvas);
  const stop = effect(() => {
    isDark.value;
    follow();
    drawSoon();
  });
  return () => {
    stop();
    observer.disconnect();
    cancelAnimationFrame(frame);
  };
}
