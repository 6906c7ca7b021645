// The chain as a table: a column for each joint from the tail to the head. A joint is dragged to another place; its handle
// moves it with the arrow keys, too.
import { useSignal } from '@preact/signals';
import { useLayoutEffect, useRef } from 'preact/hooks';
import { onFrame } from '../view/frame_clock.js';
import { addFront } from '../view/front.js';
import type { DraftRobot } from '../wire/messages.js';
import { columnAfter, placeAt, scrollStep } from './joint_drag.js';
import type { MakeApp } from './make_app.js';
import { axisLetter, axisOfAngle, axisWord, fromTail } from '../state/robot_text.js';

const smallestDrag = 4; // pixels: a press with a trembling hand moves nothing

interface Grip {
  joint: number;
  begin: number; // pixels
  x: number;
}

export function ChainTable({ app, robot }: { app: MakeApp; robot: DraftRobot }) {
  const frame = useRef<HTMLDivElement>(null);
  const grip = useRef<Grip | null>(null);
  const hasMoved = useRef(false); // the click behind a drag chooses nothing
  const place = useSignal<number | null>(null); // where the dragged joint will come
  const count = robot.joints.length;
  const order = fromTail(count);
  const chosen = app.chosenJoints.value;
  const hovered = app.view.selection.hoveredJoint.value;
  const obstacle = app.obstacle() ?? robot.obstacle;
  const nameOf = (joint: number) => robot.joints[joint]?.name ?? '';
  const isDragging = place.value !== null;
  const dragged = isDragging ? (grip.current?.joint ?? null) : null;

  const columns = () => [...(frame.current?.querySelectorAll('thead th[scope=col]') ?? [])].map((column) => column.getBoundingClientRect());
  const giveUp = () => {
    grip.current = null;
    place.value = null;
  };
  useLayoutEffect(() => {
    if (!isDragging) return undefined;
    const onKey = (event: KeyboardEvent) => {
      if (event.key === 'Escape') giveUp(); // for a robot on a bus it is STOP as well
    };
    window.addEventListener('keydown', onKey, { capture: true });
    const stops = [
      addFront({ isOpen: () => place.peek() !== null, close: giveUp }),
      onFrame(() => {
        const step = grip.current === null || frame.current === null ? 0 : scrollStep(grip.current.x, frame.current.getBoundingClientRect());
        if (step === 0) return;
        frame.current!.scrollLeft += step;
        place.value = placeAt(grip.current!.x, columns());
      }),
    ];
    return () => {
      stops.forEach((stop) => stop());
      window.removeEventListener('keydown', onKey, { capture: true });
    };
  }, [isDragging]);

  const press = (event: PointerEvent, joint: number) => {
    hasMoved.current = false;
    if (obstacle !== null || count < 2 || event.button !== 0 || event.shiftKey || event.ctrlKey) return;
    // A finger scrolls the table, except at the handles.
    if (event.pointerType === 'touch' && !(event.currentTarget as Element).classList.contains('handle')) return;
    (event.currentTarget as Element).setPointerCapture(event.pointerId);
    grip.current = { joint, begin: event.clientX, x: event.clientX };
  };
  const drag = (event: PointerEvent) => {
    const held = grip.current;
    if (held === null) return;
    held.x = event.clientX;
    if (!hasMoved.current && Math.abs(held.x - held.begin) < smallestDrag) return;
    hasMoved.current = true;
    place.value = placeAt(held.x, columns());
  };
  const release = () => {
    const held = grip.current;
    const at = place.peek();
    giveUp();
    if (held !== null && at !== null) void app.moveJoint(held.joint, count - 1 - columnAfter(count - 1 - held.joint, at));
  };
  const pointers = (joint: number) => ({
    onPointerDown: (event: PointerEvent) => press(event, joint),
    onPointerMove: drag,
    onPointerUp: release,
    onPointerCancel: giveUp,
    onPointerEnter: () => (app.view.selection.hoveredJoint.value = joint),
    onClick: (event: MouseEvent) => {
      if (!hasMoved.current) app.chooseJoint(joint, event.shiftKey || event.ctrlKey);
    },
  });
  const moveByKey = async (event: KeyboardEvent, joint: number) => {
    const to = joint + (event.key === 'ArrowLeft' ? 1 : event.key === 'ArrowRight' ? -1 : 0);
    if (to === joint) return;
    event.preventDefault();
    if (obstacle !== null || to < 0 || to >= count) return;
    if (await app.moveJoint(joint, to)) frame.current?.querySelector<HTMLElement>(`.handle[data-joint="${to}"]`)?.focus();
  };
  // Of the line where the dragged joint will come.
  const lineAt = (column: number) =>
    place.value === column ? 'line-before' : place.value === count && column === count - 1 ? 'line-behind' : '';
  const classOf = (joint: number, column: number) =>
    [lineAt(column), joint === dragged && 'dragged', chosen.includes(joint) && 'chosen', joint === hovered && 'hovered'].filter(Boolean).join(' ');

  return (
    <div class="chain" data-testid="chain" ref={frame} onPointerLeave={() => (app.view.selection.hoveredJoint.value = null)}>
      <table>
        <caption>From the tail to the head</caption>
        <thead>
          <tr>
            <th scope="row">joint</th>
            {order.map((joint, column) => (
              <th scope="col" key={joint} class={classOf(joint, column)}>
                <button type="button" aria-pressed={chosen.includes(joint)} title={`${axisWord(robot.joints[joint]!.axis)}. Shift: choose several. Drag: another place.`} {...pointers(joint)}>
                  {nameOf(joint)}
                </button>
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          <tr>
            <th scope="row">axis</th>
            {order.map((joint, column) => {
              const axis = robot.joints[joint]!.axis;
              const isPitch = axisLetter(axis) === 'p';
              return (
                <td key={joint} class={classOf(joint, column)}>
                  <button
                    type="button"
                    disabled={app.obstacle() !== null}
                    aria-label={`axis of ${nameOf(joint)}: ${axisWord(axis)}`}
                    title={`${axisWord(axis)}. Press: ${isPitch ? 'yaw' : 'pitch'}.`}
                    onClick={() => void app.changes.tell('robot.axis', { joints: [joint], value: axisOfAngle(isPitch ? 90 : 0) })}
                  >
                    {axisLetter(axis)}
                  </button>
                </td>
              );
            })}
          </tr>
        </tbody>
        <tfoot>
          <tr>
            <th scope="row">place</th>
            {order.map((joint, column) => (
              <td key={joint} class={classOf(joint, column)}>
                <button
                  type="button"
                  class="handle"
                  data-joint={joint}
                  data-arrows=""
                  aria-label={`place of ${nameOf(joint)}: left and right arrow keys move it`}
                  title={obstacle ?? 'Drag it to another place, or press the arrow keys'}
                  onKeyDown={(event) => void moveByKey(event, joint)}
                  {...pointers(joint)}
                >
                  ⇔
                </button>
              </td>
            ))}
          </tr>
        </tfoot>
      </table>
    </div>
  );
}
