// The world from above or from the side: objects, the robot at its start, and where it will go. Objects and the start are
// dragged here; arrow keys move the chosen object.
import { useSignal } from '@preact/signals';
import { useEffect, useLayoutEffect, useRef } from 'preact/hooks';
import { ForwardKinematics } from '../geometry/forward_kinematics.js';
import { flat, headingOf, lifted, outline, type Plane, type Point } from '../geometry/outline.js';
import { fromAxisAngle, multiply, poseFromArray, type Pose, type Vector } from '../geometry/quaternion.js';
import { decimalsOf, formatNumber, roundStep } from '../state/parameter_values.js';
import type { RobotDocument } from '../wire/messages.js';
import { fittedView, isGround, largestScale, seenPoints, showsAny, smallestScale, type View } from './fitted_view.js';
import { bodyOf, startOfRobot, type MakeApp } from './make_app.js';

const lineDistance = 70; // pixels between two lines of the grid, at least
const labelHeight = 14; // pixels
const wheelFactor = 0.0015;
const keySteps = { fine: 0.01, usual: 0.1 }; // metres
const turnStep = 5; // degrees
const handleDistance = 46; // pixels
const snap = 0.01; // metres; Alt: none
const smallestDrag = 4; // pixels: a press with a trembling hand moves nothing
const background = -2; // in the place of the number of an object

// What the pointer holds: where it was pressed in the world, and what it moves.
interface Grip {
  kind: 'view' | 'object' | 'start' | 'turn';
  number: number;
  at: Point;
  pose: Pose;
  isAlone: boolean;
  hasMoved: boolean;
}

function pathOf(points: readonly Point[]): string {
  return points.map(([x, y]) => `${x.toFixed(5)},${y.toFixed(5)}`).join(' ');
}

// Metres between two lines: 1, 2 or 5 times a power of ten.
function gridStep(scale: number): number {
  const least = lineDistance / scale;
  const step = roundStep(least);
  return step < least * 0.999 ? roundStep(step * 2.5) : step;
}

function Grid({ view, size }: { view: View; size: Point }) {
  const step = gridStep(view.scale);
  const lines = (axis: 0 | 1) => {
    const half = size[axis] / view.scale / 2;
    const first = Math.ceil((view.centre[axis] - half) / step);
    const last = Math.floor((view.centre[axis] + half) / step);
    return Array.from({ length: Math.max(0, Math.min(200, last - first + 1)) }, (_, i) => (first + i) * step);
  };
  const pixel = (axis: 0 | 1, value: number) =>
    size[axis] / 2 + (axis === 0 ? 1 : -1) * (value - view.centre[axis]) * view.scale;
  const text = (value: number) => formatNumber(value, decimalsOf(step));
  return (
    <g class="grid" aria-hidden="true">
      {lines(0).map((x) => (
        <g key={`x${x}`}>
          <line class={x === 0 ? 'axis' : ''} x1={pixel(0, x)} x2={pixel(0, x)} y1={0} y2={size[1]} />
          <text x={pixel(0, x) + 3} y={size[1] - 4}>
            {text(x)}
          </text>
        </g>
      ))}
      {lines(1).map((y) => (
        <g key={`y${y}`}>
          <line class={y === 0 ? 'axis' : ''} y1={pixel(1, y)} y2={pixel(1, y)} x1={0} x2={size[0]} />
          {pixel(1, y) > labelHeight && (
            <text x={3} y={pixel(1, y) - 3}>
              {text(y)}
            </text>
          )}
        </g>
      ))}
    </g>
  );
}

export function WorldMap({ app, plane }: { app: MakeApp; plane: Plane }) {
  const holder = useRef<SVGSVGElement>(null);
  const size = useSignal<Point | null>(null); // not known before the first layout
  const view = useSignal<View | null>(null); // null: robot and objects fill the drawing, until a person chooses another view
  const grip = useRef<Grip | null>(null);
  const pointers = useRef(new Map<number, Point>()).current;

  useEffect(() => {
    const element = holder.current as SVGSVGElement;
    const observer = new ResizeObserver(([entry]) => {
      const { width, height } = (entry as ResizeObserverEntry).contentRect;
      size.value = [Math.max(1, width), Math.max(1, height)];
    });
    observer.observe(element);
    const zoom = (event: WheelEvent) => {
      event.preventDefault();
      const now = present();
      const at = worldAt(event);
      const scale = Math.min(largestScale, Math.max(smallestScale, now.scale * Math.exp(-event.deltaY * wheelFactor)));
      const share = now.scale / scale;
      view.value = { scale, centre: [at[0] + (now.centre[0] - at[0]) * share, at[1] + (now.centre[1] - at[1]) * share] };
    };
    element.addEventListener('wheel', zoom, { passive: false });
    return () => {
      observer.disconnect();
      element.removeEventListener('wheel', zoom);
    };
  }, []);

  const draft = app.draft.value;
  const robot = app.page.state.draftRobot.value;
  // What is chosen, and what is new, is in the drawing. A new object is chosen before the documents with its body have come.
  const chosen = app.chosen.value;
  const chosenObject = app.chosenObject.value;
  const drawn = robot === null || chosenObject === null || bodyOf(robot, chosenObject) === undefined ? null : chosenObject.name;
  useLayoutEffect(() => {
    const object = app.chosenObject.peek();
    const now = view.peek();
    if (object === null || now === null || drawn === null) return;
    if (!showsAny(now, sizeNow(), [flat(plane, poseFromArray(object.pose).position)])) view.value = null;
  }, [chosen, drawn]);
  // Another scenario is seen anew; so is one of which nothing is in the view any more, for example after undo.
  const [refit, file] = [app.refit.value, draft?.file ?? null];
  useLayoutEffect(() => void (view.value = null), [refit, file]);
  useLayoutEffect(() => {
    const now = view.peek();
    if (now !== null && grip.current === null && !showsAny(now, sizeNow(), seenPoints(plane, draft, robot))) view.value = null;
  }, [draft, robot]);

  const shown = view.value ?? fittedView(plane, size.value, seenPoints(plane, draft, robot));
  const obstacle = app.obstacle();

  function sizeNow(): Point {
    return size.peek() ?? [1, 1];
  }

  function present(): View {
    return view.peek() ?? fittedView(plane, size.peek(), seenPoints(plane, app.draft.peek(), app.page.state.draftRobot.peek()));
  }

  function worldAt(event: { clientX: number; clientY: number }): Point {
    const box = (holder.current as SVGSVGElement).getBoundingClientRect();
    const now = present();
    return [
      now.centre[0] + (event.clientX - box.left - box.width / 2) / now.scale,
      now.centre[1] - (event.clientY - box.top - box.height / 2) / now.scale,
    ];
  }

  const press = (event: PointerEvent, kind: Grip['kind'], number: number, pose: Pose) => {
    event.stopPropagation();
    (holder.current as SVGSVGElement).setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    const isFixed = kind !== 'view' && (obstacle !== null || event.button !== 0 || event.shiftKey || pointers.size > 1);
    grip.current = { kind: isFixed ? 'view' : kind, number, at: worldAt(event), pose, isAlone: event.ctrlKey, hasMoved: false };
    if (kind === 'object' && !event.shiftKey) app.chooseObject(number);
    if (grip.current.kind !== 'view') {
      view.value = present(); // it stays where the pointer holds something
      app.beginDrag();
    }
  };

  const drag = (event: PointerEvent) => {
    const held = grip.current;
    const before = pointers.get(event.pointerId);
    if (held === null || before === undefined) return;
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    const way: Point = [event.clientX - before[0], event.clientY - before[1]];
    const now = present();
    if (pointers.size === 2) {
      const other = [...pointers].find(([id]) => id !== event.pointerId)?.[1] as Point;
      const distance = (a: Point) => Math.max(1, Math.hypot(a[0] - other[0], a[1] - other[1]));
      const scale = now.scale * (distance([event.clientX, event.clientY]) / distance(before));
      view.value = { centre: [now.centre[0] - way[0] / 2 / now.scale, now.centre[1] + way[1] / 2 / now.scale], scale };
      return;
    }
    if (held.kind === 'view') {
      view.value = { ...now, centre: [now.centre[0] - way[0] / now.scale, now.centre[1] + way[1] / now.scale] };
      return;
    }
    const at = worldAt(event);
    if (!held.hasMoved && Math.hypot(at[0] - held.at[0], at[1] - held.at[1]) * now.scale < smallestDrag) return;
    held.hasMoved = true;
    if (held.kind === 'turn') {
      const [x, y] = flat('top', held.pose.position);
      const angle = (point: Point) => Math.atan2(point[1] - y, point[0] - x);
      const turn = ((angle(at) - angle(held.at)) * 180) / Math.PI;
      const degrees = event.altKey ? turn : Math.round(turn / turnStep) * turnStep;
      const orientation = multiply(fromAxisAngle([0, 0, 1], (degrees * Math.PI) / 180), held.pose.orientation);
      app.dragObject(held.number, { position: held.pose.position, orientation }, held.isAlone);
      return;
    }
    const from = flat(plane, held.pose.position);
    const round = (value: number) => (event.altKey ? value : Math.round(value / snap) * snap);
    const to: Point = [round(from[0] + at[0] - held.at[0]), round(from[1] + at[1] - held.at[1])];
    const position = lifted(plane, to, held.pose.position);
    if (held.kind === 'start') app.dragStart(position);
    else app.dragObject(held.number, { position, orientation: held.pose.orientation }, held.isAlone);
  };

  const release = (event: PointerEvent) => {
    pointers.delete(event.pointerId);
    const held = grip.current;
    if (held !== null && held.kind !== 'view') app.endDrag();
    if (pointers.size === 0) {
      if (held?.kind === 'view' && !held.hasMoved && (held.number === background || event.shiftKey) && event.type === 'pointerup') {
        const at = worldAt(event);
        if (Math.hypot(at[0] - held.at[0], at[1] - held.at[1]) * present().scale < smallestDrag) {
          app.chooseObject(held.number >= 0 ? held.number : null, event.shiftKey);
        }
      }
      grip.current = null;
    }
  };

  const moveByKey = (event: KeyboardEvent) => {
    const number = app.chosen.peek();
    const object = app.chosenObject.peek();
    const ways: Record<string, Point> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    const turns: Record<string, number> = { PageUp: turnStep, PageDown: -turnStep };
    const way = ways[event.key];
    const turn = turns[event.key];
    if (event.key === '+' || event.key === '-') {
      const now = present();
      view.value = { ...now, scale: now.scale * (event.key === '+' ? 1.2 : 1 / 1.2) };
    } else if ((way !== undefined || turn !== undefined) && number !== null && object?.editable === true && obstacle === null) {
      event.preventDefault();
      view.value = present();
      const step = event.shiftKey ? keySteps.fine : keySteps.usual;
      const pose = app.poseOf(number, object);
      const [right, up] = flat(plane, pose.position);
      const moved: Pose =
        way !== undefined
          ? { position: lifted(plane, [right + way[0] * step, up + way[1] * step], pose.position), orientation: pose.orientation }
          : app.turned(object, headingOf(pose) + (turn ?? 0));
      app.beginDrag();
      app.dragObject(number, moved, false);
      app.endDrag();
    } else if (way !== undefined) {
      event.preventDefault();
      const now = present();
      view.value = { ...now, centre: [now.centre[0] + (way[0] * 40) / now.scale, now.centre[1] + (way[1] * 40) / now.scale] };
    }
  };

  const [width, height] = size.value ?? [1, 1];
  const transform = `translate(${width / 2} ${height / 2}) scale(${shown.scale} ${-shown.scale}) translate(${-shown.centre[0]} ${-shown.centre[1]})`;
  const head = app.drag.value?.moved.get(startOfRobot) ?? (draft === null ? null : poseFromArray(draft.head));
  const title = plane === 'top' ? 'The world from above' : 'The world from the side';
  const hovered = app.view.selection.hoveredJoint.value;
  const chosenJoints = app.chosenJoints.value;
  const isLit = (joint: number) => joint === hovered || chosenJoints.includes(joint);
  const start = app.page.state.foresightStart.value;
  const rest = app.page.state.foresight.value?.path.slice(start.length) ?? []; // that of the path before, until it comes
  return (
    <div class={`map ${plane}`}>
      <svg
        ref={holder}
        role="application"
        aria-label={`${title}. Arrow keys move the chosen object, with Shift finely; Page Up and Page Down turn it; plus and minus zoom.`}
        data-arrows=""
        data-testid={`map-${plane}`}
        tabindex={0}
        onPointerDown={(event) => press(event, 'view', background, { position: [0, 0, 0], orientation: [1, 0, 0, 0] })}
        onPointerMove={drag}
        onPointerUp={release}
        onPointerCancel={release}
        onKeyDown={moveByKey}
      >
        <Grid view={shown} size={size.value ?? [1, 1]} />
        <g transform={transform}>
          {draft?.world.objects.map((object, number) => {
            const body = robot === null ? undefined : bodyOf(robot, object);
            const pose = app.poseOf(number, object);
            const outlines = body?.shapes.map((shape) => outline(plane, pose, shape)) ?? [];
            const isFloor = isGround(outlines.flat());
            const classes = ['object', isFloor ? 'ground' : '', object.moves ? 'moves' : '', app.isChosen(number) ? 'chosen' : ''];
            const colour = object.shapes[0]?.colour ?? null;
            const fill = colour === null || isFloor ? undefined : `rgb(${colour.map((part) => Math.round(255 * part)).join()})`;
            return (
              <g
                key={number}
                class={classes.join(' ')}
                data-name={object.name}
                onPointerDown={isFloor || !object.editable ? undefined : (event) => press(event, 'object', number, pose)}
              >
                <title>{object.name}</title>
                {outlines.map((points, i) => (
                  <polygon key={i} points={pathOf(points)} style={fill === undefined ? undefined : { fill }} />
                ))}
              </g>
            );
          })}
          {draft?.world.rulers.map(({ from, to }, i) => (
            <polyline key={i} class="ruler" points={pathOf([flat(plane, from), flat(plane, to)])} />
          ))}
          {start.length > 1 && <polyline class="foresight" data-testid={`foresight-start-${plane}`} points={pathOf(start.map((point) => flat(plane, point)))} />}
          {rest.length > 1 && (
            <polyline class={start.length > 1 ? 'foresight old' : 'foresight'} data-testid={`foresight-${plane}`} points={pathOf(rest.map((point) => flat(plane, point)))} />
          )}
          {robot !== null && head !== null && (
            <g class="robot" onPointerDown={(event) => press(event, 'start', startOfRobot, head)}>
              <title>The robot at its start</title>
              <RobotOutline robot={robot} head={head} plane={plane} isLit={isLit} />
            </g>
          )}
        </g>
        {plane === 'top' && chosen !== null && <TurnHandle app={app} number={chosen} view={shown} size={size.value ?? [1, 1]} press={press} />}
      </svg>
      <div class="map-tools">
        <span class="hint">{plane === 'top' ? 'from above' : 'from the side'}</span>
        <button type="button" onClick={() => (view.value = null)} title="Shows the robot and all objects">
          All
        </button>
      </div>
    </div>
  );
}

// The link in front of a joint is lit with it, as in the 3D view.
function RobotOutline({ robot, head, plane, isLit }: { robot: RobotDocument; head: Pose; plane: Plane; isLit(joint: number): boolean }) {
  const poses = new ForwardKinematics(robot).linkPoses(head, []);
  return (
    <>
      {robot.links.map((link, i) =>
        link.shapes.map((shape, k) => (
          <polygon key={`${i}/${k}`} class={[i === 0 && 'head', isLit(i) && 'lit'].filter(Boolean).join(' ')} points={pathOf(outline(plane, poses[i] as Pose, shape))} />
        )),
      )}
    </>
  );
}

interface HandleProps {
  app: MakeApp;
  number: number;
  view: View;
  size: Point;
  press(event: PointerEvent, kind: 'turn', number: number, pose: Pose): void;
}

// A handle beside the chosen object that turns it.
function TurnHandle({ app, number, view, size, press }: HandleProps) {
  const object = app.objects.value[number];
  const body = object === undefined ? undefined : bodyOf(app.page.state.draftRobot.value as RobotDocument, object);
  if (object === undefined || body === undefined || !object.editable || app.obstacle() !== null) return null;
  const pose = app.poseOf(number, object);
  const points = body.shapes.flatMap((shape) => outline('top', pose, shape));
  if (points.length === 0 || isGround(points)) return null;
  const heading = (headingOf(pose) * Math.PI) / 180;
  const reach = Math.max(...points.map(([x, y]) => Math.hypot(x - pose.position[0], y - pose.position[1]))) * view.scale;
  const pixel = (point: Vector) => [
    size[0] / 2 + (point[0] - view.centre[0]) * view.scale,
    size[1] / 2 - (point[1] - view.centre[1]) * view.scale,
  ] as const;
  const [x, y] = pixel(pose.position);
  const length = Math.min(reach, 160) + handleDistance;
  const [right, down] = [x + length * Math.cos(heading), y - length * Math.sin(heading)];
  return (
    <g class="turn-handle" onPointerDown={(event) => press(event, 'turn', number, pose)} data-testid="turn-handle">
      <title>Drag to turn; with Alt in fine steps</title>
      <line x1={x} y1={y} x2={right} y2={down} />
      <circle cx={right} cy={down} r={9} />
    </g>
  );
}
