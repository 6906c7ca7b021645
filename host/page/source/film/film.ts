// The pictures of a film of a recording: the robot in 3D, below it the set-points of its joints. A picture belongs to a
// tick; there is no clock. The page has the elements of `proleg export --html` and this program (tools/film).
import { historyFor, loadTicks } from '../data/recording_source.js';
import type { TelemetryHistory } from '../data/telemetry_history.js';
import type { Vector } from '../geometry/quaternion.js';
import { chartTheme } from '../panels/chart_theme.js';
import { poseAt } from '../panels/scene_pose.js';
import { EmbeddedRecording } from '../player/embedded_recording.js';
import { type Ground, RobotScene } from '../scene/robot_scene.js';
import { colours } from '../scene/scene_colours.js';
import type { RobotDocument } from '../wire/messages.js';
import { drawSetpoints } from './setpoint_lines.js';

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

declare global {
  interface Window {
    // Reads the recording. Throws an Error if it is shorter than what the film needs.
    beginFilm(wishes: FilmWishes): Promise<void>;
    // The picture as the URL of a PNG file.
    drawPicture(tick: number): string;
  }
}

const oversampling = 2; // pixels drawn for each pixel of the film, in each direction
const cell = 0.15; // metres, about: the lines of the ground
const azimuth = -28; // degrees: the camera looks from the side and a little from ahead
const elevation = 17;
const distance = 1.02; // lengths of the robot
const farthest = 2; // distances of the camera: far lines would be most of the bytes
const periodsOfLines = 3;
const degree = Math.PI / 180;

class Film {
  private readonly canvas: HTMLCanvasElement;
  private readonly sceneCanvas: OffscreenCanvas;
  private readonly scene: RobotScene;
  private readonly centres = new Map<number, Vector>();
  private readonly ground: Ground;

  constructor(
    private readonly robot: RobotDocument,
    private readonly history: TelemetryHistory,
    private readonly wishes: FilmWishes,
  ) {
    const { width, height, linesHeight, isDark } = wishes;
    const sceneHeight = height - linesHeight;
    this.canvas = Object.assign(document.createElement('canvas'), { width, height });
    this.sceneCanvas = new OffscreenCanvas(width * oversampling, sceneHeight * oversampling);
    this.scene = new RobotScene(this.sceneCanvas, isDark, false, { ratio: oversampling, hasShadows: true });
    this.scene.setSize(width, sceneHeight, oversampling);
    this.scene.setRobot(robot);
    this.ground = this.groundOf();
  }

  // Lines that lie as at the start when the film ends, so that it can begin again.
  private groundOf(): Ground {
    const { first, ticks } = this.wishes;
    const from = this.meanPlace(first);
    const to = this.meanPlace(first + ticks);
    const way = Math.hypot(to[0] - from[0], to[1] - from[1]);
    const cells = Math.round(way / cell);
    return { cell: cells === 0 ? cell : way / cells, turn: Math.atan2(to[1] - from[1], to[0] - from[0]) };
  }

  // Mean of the places of the robot over a period around a tick: the camera goes with it, and so moves evenly.
  private meanPlace(tick: number): Vector {
    const { period } = this.wishes;
    const sum: [number, number, number] = [0, 0, 0];
    for (let i = 0; i < period; i += 1) {
      this.centreAt(tick - Math.floor(period / 2) + i).forEach((value, axis) => (sum[axis as 0] += value / period));
    }
    return sum;
  }

  private centreAt(tick: number): Vector {
    const known = this.centres.get(tick);
    if (known !== undefined) return known;
    this.setPose(tick);
    const centre = this.scene.robotCentre;
    this.centres.set(tick, centre);
    return centre;
  }

  private setPose(tick: number): void {
    const pose = poseAt(this.history, tick, false, false);
    if (pose !== null) this.scene.setPose(pose);
  }

  draw(tick: number): string {
    const { width, height, linesHeight, period, isDark } = this.wishes;
    const target = this.meanPlace(tick);
    const metres = distance * this.scene.robotLength;
    this.setPose(tick);
    this.scene.setShot({
      target,
      azimuth: azimuth * degree + this.ground.turn - Math.PI / 2,
      elevation: elevation * degree,
      distance: metres,
      ground: this.ground,
      farthest: farthest * metres,
    });
    this.scene.render();
    const context = this.canvas.getContext('2d') as CanvasRenderingContext2D;
    context.imageSmoothingQuality = 'high';
    context.drawImage(this.sceneCanvas, 0, 0, width, height - linesHeight);
    const box = { top: height - linesHeight, width, height: linesHeight };
    const from = Math.max(this.history.tickOf(this.history.first), tick - periodsOfLines * period);
    const span = { from, to: tick, length: periodsOfLines * period };
    const ground = colours(isDark).background.getStyle();
    drawSetpoints(context, box, this.history, this.robot, span, chartTheme(isDark), ground);
    return this.canvas.toDataURL('image/png');
  }
}

let film: Film | null = null;

window.beginFilm = async (wishes) => {
  const recording = new EmbeddedRecording(document);
  const { documents } = recording;
  const { first_tick, last_tick } = documents.recording;
  const half = Math.ceil(wishes.period / 2);
  if (wishes.first - half < first_tick || wishes.first + wishes.ticks + half > last_tick) {
    const tick = documents.telemetry.tick_us / 1e6;
    const seconds = (ticks: number) => `${Number((ticks * tick).toFixed(2))} s`;
    throw new Error(
      `found a recording from ${seconds(first_tick)} to ${seconds(last_tick)}, expected one from ${seconds(wishes.first - half)} ` +
        `to ${seconds(wishes.first + wishes.ticks + half)}: half a period more than the film at each end`,
    );
  }
  const history = historyFor(last_tick - first_tick + 1);
  await loadTicks(recording, history, first_tick, last_tick);
  film = new Film(documents.robot, history, wishes);
};

window.drawPicture = (tick) => {
  if (film === null) throw new Error('found a picture before the film, expected beginFilm() first');
  return film.draw(tick);
};
