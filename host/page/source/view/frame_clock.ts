// One animation frame loop for everything that draws. Hidden tabs have no frames: nothing draws there, data still come in.

type Drawer = (time: number) => void;

const drawers = new Set<Drawer>();
const limitedPeriod = 1000 / 30; // milliseconds
const tolerance = 8; // half a frame of most displays
let isLimited = false;
let due = 0;
let isAsked = false; // whether a frame of the browser was requested
let timer: ReturnType<typeof setTimeout> | undefined;

function ask(): void {
  if (!isAsked && drawers.size > 0) {
    isAsked = true;
    requestAnimationFrame(frame);
  }
}

function frame(time: number): void {
  isAsked = false;
  if (isLimited && time < due - tolerance) {
    ask();
    return;
  }
  due = Math.max(due, time - limitedPeriod) + limitedPeriod;
  drawers.forEach((draw) => draw(time));
  if (isLimited) {
    // A requested frame makes the browser examine the whole page, also if nothing is drawn in it.
    clearTimeout(timer);
    timer = setTimeout(ask, limitedPeriod / 2);
  } else {
    ask();
  }
}

// Limits drawing to 30 frames a second, so that a computer that draws slowly has time for the controls.
export function limitFrameRate(isOn: boolean): void {
  isLimited = isOn;
}

// Draws at the next frame regardless of the limit, because the user waits for data that have arrived.
export function drawSoon(): void {
  due = 0;
  ask();
}

// Calls `draw` at each frame until the returned function is called.
export function onFrame(draw: Drawer): () => void {
  drawers.add(draw);
  ask();
  return () => void drawers.delete(draw);
}
