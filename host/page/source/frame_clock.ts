// One animation frame loop for everything that draws. Hidden tabs have no frames: nothing draws there, data still come in.

type Drawer = (time: number) => void;

const drawers = new Set<Drawer>();

function frame(time: number): void {
  if (drawers.size === 0) {
    return;
  }
  drawers.forEach((draw) => draw(time));
  requestAnimationFrame(frame);
}

// Calls `draw` at each frame until the returned function is called.
export function onFrame(draw: Drawer): () => void {
  drawers.add(draw);
  if (drawers.size === 1) {
    requestAnimationFrame(frame);
  }
  return () => void drawers.delete(draw);
}
