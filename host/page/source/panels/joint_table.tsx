// A row for each joint with what it does at the time cursor.
import { useEffect, useRef } from 'preact/hooks';
import { onFrame } from '../frame_clock.js';
import type { RobotView } from '../robot_view.js';
import { noValue, type Joint } from '../wire/messages.js';

const period = 100; // milliseconds: faster cannot be read
const rowsOfAFrame = 12; // more at once would hold up the controls

const columns = [
  { title: 'set-point', unit: '°', signal: 'setpoint', decimals: 1 },
  { title: 'angle', unit: '°', signal: 'angle', decimals: 1 },
  { title: 'lag', unit: '°', signal: '', decimals: 1 },
  { title: 'current', unit: 'mA', signal: 'current', decimals: 0 },
  { title: 'torque', unit: 'mNm', signal: 'torque', decimals: 0 },
] as const;

function valueOf(app: RobotView, signal: string, joint: number, row: number): number | null {
  const raw = app.rowsAtCursor.valueAt(signal, joint, row);
  return raw === noValue ? null : raw * (app.rowsAtCursor.rings.get(signal)?.scale ?? 1);
}

function texts(app: RobotView, joint: number, row: number): string[] {
  const setpoint = valueOf(app, 'setpoint', joint, row);
  const angle = valueOf(app, 'angle', joint, row);
  const numbers = columns.map(({ signal, decimals }) => {
    const value = signal !== '' ? valueOf(app, signal, joint, row) : setpoint === null || angle === null ? null : setpoint - angle;
    return value === null ? '–' : value.toFixed(decimals).replace(/^-(0(\.0*)?)$/, '$1');
  });
  // Contacts belong to links; the row shows those of the link in front of the joint.
  const bits = app.rowsAtCursor.valueAt('contact', joint, row);
  return [...numbers, bits === noValue ? '' : `${(bits & 1) !== 0 ? '●' : '○'} ${(bits & 2) !== 0 ? '●' : '○'}`];
}

// Past Preact: 60 rows of text ten times a second.
function write(element: HTMLTableRowElement, values: string[]): void {
  values.forEach((text, i) => {
    const cell = element.cells[i + 1];
    if (cell !== undefined && cell.textContent !== text) cell.textContent = text;
  });
}

function JointRow({ app, joint, index }: { app: RobotView; joint: Joint; index: number }) {
  const isHovered = app.selection.hoveredJoint.value === index;
  return (
    <tr
      class={isHovered ? 'hovered' : ''}
      data-joint={index}
      onPointerEnter={() => (app.selection.hoveredJoint.value = index)}
      onPointerLeave={() => (app.selection.hoveredJoint.value = null)}
    >
      <th scope="row">{joint.name}</th>
      {columns.map((column) => (
        <td key={column.title} data-value={column.title} />
      ))}
      <td data-value="contacts" />
    </tr>
  );
}

export function JointTable({ app }: { app: RobotView }) {
  const body = useRef<HTMLTableSectionElement>(null);
  useEffect(() => {
    let last = 0;
    let lastKey = '';
    let row = 0; // of the history, which the table is being filled with
    let next = Infinity; // joint
    return onFrame((now) => {
      const { rowsAtCursor: history, time } = app;
      const tick = time.shownTick(app.newestTick);
      const key = `${history.run}/${history.end}/${tick}`;
      const elements = body.current?.rows ?? [];
      if (next >= elements.length) {
        if (key === lastKey || now - last < period) {
          return;
        }
        last = now;
        lastKey = key;
        row = Math.min(history.end - 1, history.rowAtTick(tick));
        next = 0;
      }
      for (const end = Math.min(elements.length, next + rowsOfAFrame); next < end; next += 1) {
        write(elements[next] as HTMLTableRowElement, texts(app, next, row));
      }
    });
  }, []);
  const robot = app.state.robot.value;
  return (
    <section class="panel joint-panel" aria-label="Joints">
      <h2>Joints</h2>
      <div class="table-frame" tabIndex={0} role="group" aria-label="Table of joints">
        <table data-testid="joints">
          <thead>
            <tr>
              <th scope="col">joint</th>
              {columns.map((column) => (
                <th scope="col" key={column.title}>
                  {column.title} <span class="unit">{column.unit}</span>
                </th>
              ))}
              <th scope="col" title="Ground contacts of the link in front of the joint: rear, front">
                contacts
              </th>
            </tr>
          </thead>
          <tbody ref={body}>
            {robot?.joints.map((joint, index) => (
              <JointRow key={joint.name} app={app} joint={joint} index={index} />
            ))}
          </tbody>
        </table>
      </div>
    </section>
  );
}
