// A small picture of a robot: from the side if all its joints pitch, else from above. It follows the robot; marks on the ground
// show that it moves.
import { ForwardKinematics } from '../geometry/forward_kinematics.js';
import { flat, outline, type Plane, type Point } from '../geometry/outline.js';
import { poseFromArray, type Pose } from '../geometry/quaternion.js';
import { axisAngle } from '../state/robot_text.js';
import type { TileRobot, TileRow } from './tile_messages.js';

export interface PictureColours {
  sky: string;
  ground: string;
  mark: string;
  text: string;
  obstacle: string;
  link: string;
  head: string;
  edge: string;
}

export const lightColours: PictureColours = { sky: '#eaf0f7', ground: '#cfd6de', mark: '#aab4c0', text: '#46505c', obstacle: '#d3c7b0', link: '#6f8fb5', head: '#1f5fae', edge: '#34445a' };
export const darkColours: PictureColours = { sky: '#14181e', ground: '#2a3038', mark: '#4a5461', text: '#a9b4c0', obstacle: '#5b4f3b', link: '#6f8fb5', head: '#62aeff', edge: '#dbe6f3' };

const shownLengths = 1.9; // width of the picture in lengths of the robot
const groundLevel = 0.8; // of the height of the picture, from above
const mostMarks = 6;
const labelWidth = 36; // pixels
const largestObstacle = 40; // metres; what is larger is ground
const mostObstacles = 300;

const distanceOf = (a: Point, b: Point) => Math.hypot(a[0] - b[0], a[1] - b[1]);

// The smallest of 1, 2, 5 times a power of ten that is not smaller, in metres.
export function markStep(least: number): number {
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5].map((factor) => factor * power).find((step) => step >= least * 0.999) ?? 10 * power;
}

// A number without digits that mean nothing: 0.3, not 0.30000000000000004.
export function markText(metres: number): string {
  return `${Number(metres.toFixed(3))} m`;
}

export class RobotPicture {
  private readonly kinematics: ForwardKinematics;
  private readonly length: number; // metres
  private readonly pitches: boolean;
  private readonly obstacles: Record<Plane, Point[][]>;

  constructor(private readonly robot: TileRobot) {
    this.kinematics = new ForwardKinematics(robot);
    this.pitches = robot.joints.every(({ axis }) => axisAngle(axis) === 0);
    const places = robot.links.map(({ pose }) => poseFromArray(pose).position);
    const sum = places.slice(1).reduce((all, place, i) => all + Math.hypot(...place.map((value, k) => value - (places[i]?.[k] ?? 0))), 0);
    this.length = Math.max(sum * (1 + 1 / Math.max(1, robot.joints.length)), 0.05);
    this.obstacles = { side: this.outlinesOf('side'), top: this.outlinesOf('top') };
  }

  // From the side only while the robot goes along the axis that lies in the picture.
  planeOf(links: readonly Pose[]): Plane {
    const [head, tail] = [links[0]?.position ?? [0, 0, 0], links.at(-1)?.position ?? [0, 0, 0]];
    return this.pitches && Math.abs(head[1] - tail[1]) >= Math.abs(head[0] - tail[0]) ? 'side' : 'top';
  }

  draw(context: CanvasRenderingContext2D, width: number, height: number, row: TileRow, colours: PictureColours): void {
    const links = this.kinematics.linkPoses(poseFromArray(row.head), row.angles);
    const plane = this.planeOf(links);
    const scale = width / (shownLengths * this.length); // pixels for a metre
    const places = links.map(({ position }) => flat(plane, position));
    const middle = (axis: 0 | 1) => places.reduce((sum, place) => sum + place[axis], 0) / places.length;
    // In steps, so that the ground does not tremble with the robot.
    const level = plane === 'side' ? Math.floor(middle(1) / this.length) * this.length : middle(1);
    const toPicture = ([right, up]: Point): Point => [
      width / 2 + (right - middle(0)) * scale,
      height * (plane === 'side' ? groundLevel : 0.5) - (up - level) * scale,
    ];
    context.fillStyle = plane === 'side' ? colours.sky : colours.ground;
    context.fillRect(0, 0, width, height);
    const window: [Point, Point] = [
      [middle(0) - width / 2 / scale, level - height / scale],
      [middle(0) + width / 2 / scale, level + height / scale],
    ];
    this.drawGround(context, plane, toPicture, window, [width, height], colours);
    context.fillStyle = colours.obstacle;
    for (const points of this.obstacles[plane]) {
      if (points.some(([right]) => right > window[0][0]) && points.some(([right]) => right < window[1][0])) fill(context, points.map(toPicture));
    }
    // What is between the links: joints have no shapes.
    context.strokeStyle = colours.edge;
    context.lineWidth = 3;
    trace(context, places.map(toPicture));
    context.stroke();
    context.lineWidth = 1;
    this.robot.links.forEach(({ shapes }, i) => {
      context.fillStyle = i === 0 ? colours.head : colours.link;
      for (const shape of shapes) {
        fill(context, outline(plane, links[i] as Pose, shape).map(toPicture));
        context.stroke();
      }
    });
  }

  private drawGround(
    context: CanvasRenderingContext2D,
    plane: Plane,
    toPicture: (point: Point) => Point,
    [lowest, highest]: [Point, Point],
    [width, height]: readonly [number, number],
    colours: PictureColours,
  ): void {
    const step = markStep((highest[0] - lowest[0]) / mostMarks);
    if (plane === 'side') {
      const [left, top] = toPicture([lowest[0], 0]);
      const [right] = toPicture([highest[0], 0]);
      context.fillStyle = colours.ground;
      context.fillRect(left, top, right - left, Math.max(0, height - top));
    }
    context.strokeStyle = colours.mark;
    context.fillStyle = colours.text;
    context.lineWidth = 1;
    context.font = '10px system-ui, sans-serif';
    context.textAlign = 'center';
    for (let mark = Math.ceil(lowest[0] / step) * step; mark <= highest[0]; mark += step) {
      const [x, y] = plane === 'side' ? toPicture([mark, 0]) : [toPicture([mark, 0])[0], 0];
      line(context, [x, y], [x, plane === 'side' ? y + 9 : height]);
      if (x < labelWidth / 2 || x > width - labelWidth / 2) continue;
      context.fillText(markText(mark), x, plane === 'side' ? Math.min(y + 20, height - 3) : height - 4);
    }
    if (plane === 'side') return;
    for (let mark = Math.ceil(lowest[1] / step) * step; mark <= highest[1]; mark += step) {
      line(context, [toPicture([lowest[0], mark])[0], toPicture([0, mark])[1]], [toPicture([highest[0], mark])[0], toPicture([0, mark])[1]]);
    }
  }

  // Of hills only the box around them is known, which would hide the robot.
  private outlinesOf(plane: Plane): Point[][] {
    const found = this.robot.terrain.flatMap(({ pose, shapes }) =>
      shapes.filter(({ kind }) => kind !== 'mesh').map((shape) => outline(plane, poseFromArray(pose), shape)),
    );
    return found.filter((points) => points.every((point) => distanceOf(point, points[0] as Point) < largestObstacle)).slice(0, mostObstacles);
  }
}

function line(context: CanvasRenderingContext2D, from: Point, to: Point): void {
  trace(context, [from, to]);
  context.stroke();
}

function trace(context: CanvasRenderingContext2D, points: readonly Point[]): void {
  context.beginPath();
  for (const point of points) context.lineTo(...point);
}

function fill(context: CanvasRenderingContext2D, points: readonly Point[]): void {
  trace(context, points);
  context.closePath();
  context.fill();
}
