// The table of joints: a row for each joint with its values at the time cursor.
import { useEffect, useRef } from 'preact/hooks';
import { onFrame } from '../view/frame_clock.js';
import type { RobotView } from '../view/robot_view.js';
import { currentLimitOf, currentState } from '../state/module_text.js';
import type { Joint } from '../wire/messages.js';
import { areComing, comparedValueOf, contactText, numberText, valueOf } from './joint_values.js';
import { ModuleCell } from './module_state.js';

const period = 150; // milliseconds: faster changes cannot be read
const rowsOfAFrame = 30; // more rows in one frame would delay the controls

// The contents of a cell for a row of the history. `tone`: a class for its colour.
interface CellText {
  text: string;
  tone?: string;
}

export interface JointColumn {
  title: string;
  heading?: string; // shorter than title and unit
  unit: string;
  help?: string;
  read(app: RobotView, joint: number, row: number): CellText;
}

const measured = (title: string, unit: string, signal: string, decimals: number): JointColumn => ({
  title,
  unit,
  read: (app, joint, row) => ({ text: numberText(valueOf(app, signal, joint, row), decimals) }),
});

const setpoint = measured('set-point', '°', 'setpoint', 1);
const lag: JointColumn = {
  title: 'lag',
  unit: '°',
  read: (app, joint, row) => {
    const [wanted, angle] = [valueOf(app, 'setpoint', joint, row), valueOf(app, 'angle', joint, row)];
    return { text: numberText(wanted === null || angle === null ? null : wanted - angle, 1) };
  },
};
const contacts: JointColumn = {
  title: 'contacts',
  unit: '',
  help: 'Ground contacts of the link in front of the joint: rear, front',
  read: (app, joint, row) => ({ text: contactText(app, joint, row), tone: 'contacts' }),
};

const simulated = [
  setpoint,
  measured('angle', '°', 'angle', 1),
  lag,
  measured('current', 'mA', 'current', 0),
  measured('torque', 'mNm', 'torque', 0),
  contacts,
];

// Additional columns for a second recording.
const difference = (title: string, unit: string, signal: string, decimals: number): JointColumn => ({
  title: `Δ ${title}`,
  heading: 'Δ',
  unit,
  help: `${title} of the second recording less that of the first`,
  read: (app, joint, row) => {
    const [own, other] = [valueOf(app, signal, joint, row), comparedValueOf(app, signal, joint, app.rowsAtCursor.tickOf(row))];
    const text = numberText(own === null || other === null ? null : other - own, decimals);
    return { text, tone: Math.abs(Number(text)) > 0 ? 'differs' : '' };
  },
});

const compared = (
  [
    ['set-point', '°', 'setpoint', 1],
    ['angle', '°', 'angle', 1],
    ['current', 'mA', 'current', 0],
    ['torque', 'mNm', 'torque', 0],
  ] as const
).flatMap(([title, unit, signal, decimals]) => [measured(title, unit, signal, decimals), difference(title, unit, signal, decimals)]);

const angleOnBus: JointColumn = {
  title: 'angle',
  unit: '°',
  help: 'Measured by the servo. A joint that is not measured is drawn at its set-point.',
  read: (app, joint, row) => {
    const angle = valueOf(app, 'angle', joint, row);
    const isAtSetpoint = angle === null && valueOf(app, 'setpoint', joint, row) !== null;
    return isAtSetpoint ? { text: 'not measured', tone: 'missing' } : { text: numberText(angle, 1) };
  },
};

const currentOnBus: JointColumn = {
  title: 'current',
  unit: 'mA',
  help: 'Measured by the module, against its limit. Too much for too long is a fault: the joint goes limp.',
  read: (app, joint, row) => currentState(valueOf(app, 'current', joint, row), currentLimitOf(app.state.bus.peek(), joint)),
};

const onBus = [setpoint, angleOnBus, lag, currentOnBus, contacts];

// The cells are written without Preact, because there are 60 rows of text ten times a second.
function write(element: HTMLTableRowElement, values: readonly CellText[]): void {
  values.forEach(({ text, tone = '' }, i) => {
    const cell = element.cells[i + 1];
    if (cell === undefined) return;
    if (cell.textContent !== text) cell.textContent = text;
    if (cell.className !== tone) cell.className = tone;
  });
}

function JointRow({ app, joint, index, columns }: { app: RobotView; joint: Joint; index: number; columns: readonly JointColumn[] }) {
  const isHovered = app.selection.hoveredJoint.value === index;
  const isOnBus = app.state.busSession.value !== null;
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
      {isOnBus && <ModuleCell app={app} joint={index} />}
    </tr>
  );
}

export function JointTable({ app }: { app: RobotView }) {
  const isOnBus = app.state.busSession.value !== null;
  const columns = isOnBus ? onBus : (app.compared?.value ?? null) !== null ? compared : simulated;
  const body = useRef<HTMLTableSectionElement>(null);
  useEffect(() => {
    let last = 0;
    let lastKey = '';
    let row = 0; // row of the history with which the table is being filled
    let next = Infinity; // next joint to be written
    return onFrame((now) => {
      const { rowsAtCursor: history, time } = app;
      const tick = time.shownTick(app.newestTick);
      const other = app.compared?.peek()?.reader.rowsAtCursor;
      const key = [history.run, history.end, tick, other?.run, other?.end].join('/');
      const elements = body.current?.rows ?? [];
      if (next >= elements.length) {
        if (key === lastKey || now - last < period || areComing(app, tick)) {
          return;
        }
        last = now;
        lastKey = key;
        row = Math.min(history.end - 1, history.rowAtTick(tick));
        next = 0;
      }
      for (const end = Math.min(elements.length, next + rowsOfAFrame); next < end; next += 1) {
        const values = columns.map((column) => column.read(app, next, row));
        write(elements[next] as HTMLTableRowElement, values);
      }
      if (next >= elements.length && body.current !== null) {
        body.current.dataset['tick'] = String(history.tickOf(row));
      }
    });
  }, [columns]);
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
                <th scope="col" key={column.title} title={column.help}>
                  {column.heading ?? column.title} {column.heading === undefined && <span class="unit">{column.unit}</span>}
                </th>
              ))}
              {isOnBus && <th scope="col">module</th>}
            </tr>
          </thead>
          <tbody ref={body}>
            {robot?.joints.map((joint, index) => (
              <JointRow key={joint.name} app={app} joint={joint} index={index} columns={columns} />
            ))}
          </tbody>
        </table>
      </div>
    </section>
  );
}
