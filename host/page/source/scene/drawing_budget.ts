// Chooses the detail of the 3D view, so that drawing leaves time for the controls. It is called for each animation frame:
// on a computer that cannot keep up, frames come late.

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

// The durations below are in milliseconds.
const window = 1000; // duration over which frames are counted
const pause = 1000; // duration without a frame that means that the page was hidden
export const slowFrame = 34; // mean duration of a frame from which drawing is too expensive
// The limit of the mean if the processor draws, which needs time for the robot and the controls as well.
export const slowFrameInSoftware = 24;
const quickFrame = 20; // mean duration of a frame up to which more detail may be possible
const shortestPatience = 10000; // duration of quick frames before an attempt at more detail
const longestPatience = 600000;
const fewestDrawn = 5; // frames in a window that is long enough for a decision

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

  // Counts an animation frame at `now`; `hasDrawn`: the view was drawn in it. Returns whether the level has changed.
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
