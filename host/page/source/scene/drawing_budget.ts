// How much detail the 3D view has, so that drawing leaves time for the controls. It is told of each animation frame: where
// the computer cannot keep up, frames come late.

export interface Detail {
  ratio: number; // most device pixels for each CSS pixel
  hasShadows: boolean;
}

export const details: readonly Detail[] = [
  { ratio: 1.5, hasShadows: true },
  { ratio: 1, hasShadows: true },
  { ratio: 1, hasShadows: false },
  { ratio: 0.75, hasShadows: false },
  { ratio: 0.5, hasShadows: false },
];

// In milliseconds.
const window = 1000; // over which frames are counted
const pause = 1000; // without a frame: the page was hidden
export const slowFrame = 34; // mean: drawing is too expensive
// Mean, where the processor draws: it needs time for the robot and the controls as well.
export const slowFrameInSoftware = 24;
const quickFrame = 20; // mean: more detail may be possible
const shortestPatience = 10000; // of quick frames before an attempt at more detail
const longestPatience = 600000;
const fewestDrawn = 5; // in a window that says something about drawing

export class DrawingBudget {
  private begin: number | null = null;
  private last = 0;
  private frames = 0;
  private drawn = 0;
  private quickFor = 0;
  private patience = shortestPatience;
  private isAttempt = false; // the present level is an attempt at more detail

  constructor(
    public level: number,
    private readonly slowFrame: number,
  ) {}

  get detail(): Detail {
    return details[this.level] as Detail;
  }

  // An animation frame at `now`; `hasDrawn`: the view was drawn in it. True if the level has changed.
  note(now: number, hasDrawn: boolean): boolean {
    if (this.begin === null || now - this.last > pause) {
      this.restart(now);
      return false;
    }
    this.last = now;
    this.frames += 1;
    this.drawn += hasDrawn ? 1 : 0;
    const time = now - this.begin;
    if (time < window) {
      return false;
    }
    const mean = time / this.frames;
    const saysSomething = this.drawn >= Math.min(fewestDrawn, this.frames);
    this.restart(now);
    return saysSomething && this.judge(mean, time);
  }

  private restart(now: number): void {
    this.begin = now;
    this.last = now;
    this.frames = 0;
    this.drawn = 0;
  }

  private judge(mean: number, time: number): boolean {
    const before = this.level;
    if (mean > this.slowFrame) {
      if (this.isAttempt) this.patience = Math.min(longestPatience, 2 * this.patience);
      this.isAttempt = false;
      this.quickFor = 0;
      this.level = Math.min(details.length - 1, this.level + (mean > 2 * this.slowFrame ? 2 : 1));
    } else if (mean > quickFrame) {
      this.quickFor = 0;
    } else {
      this.quickFor += time;
      if (this.quickFor >= this.patience && this.level > 0) {
        this.level -= 1;
        this.isAttempt = true;
        this.quickFor = 0;
      }
    }
    return this.level !== before;
  }
}
