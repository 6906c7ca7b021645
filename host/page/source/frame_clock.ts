// One animation frame loop for everything that draws. Hidden tabs have no frames: nothing draws there, data still come in.

type Drawer = (time: number) => void;

const drawers = new Set<Drawer>();
const limitedPeriod = 1000 / 30; // milliseconds
const tolerance = 8; // half a frame of most displays
let isLimited = false;
let due = 0;
let isAsked = false; // a frame, of the browser
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
    // A frame that is asked for costs the browser a look at the whole page, also if nothing draws in it.
    clearTimeout(timer);
    timer = setTimeout(ask, limitedPeriod / 2);
  } else {
    ask();
  }
}

// At most 30 frames a second: for a computer that draws slowly, so that it has time for the controls.
export function limitFrameRate(isOn: boolean): void {
  isLimited = isOn;
}

// Draws at the next frame, whatever the limit: the user waits for something that has come.
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
