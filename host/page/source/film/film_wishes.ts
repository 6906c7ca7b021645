// What a film shows. Ticks count as in the recording.
export interface FilmWishes {
  first: number; // tick of the first picture
  ticks: number; // the film ends before tick first + ticks
  period: number; // ticks of a period of the gait; a film of whole periods can begin again without a jump
  width: number; // pixels
  height: number;
  linesHeight: number; // pixels of `height`: the set-points
  isDark: boolean;
}
