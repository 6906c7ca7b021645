// The joints of the draft as a table, to copy from and to paste into.
import { useSignal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import { CellTable } from '../panels/cell_table.js';
import { Dialog } from '../panels/dialog.js';
import { type CellProblem, type CellRange, rangeOf } from '../state/value_table.js';
import { openDialog } from '../view/dialogs.js';
import type { DraftRobot } from '../wire/messages.js';
import { copyJoints, jointCellText, jointColumns, pasteJoints, type JointPaste } from './joint_table.js';
import type { MakeApp } from './make_app.js';

export function JointTableDialog({ app, robot }: { app: MakeApp; robot: DraftRobot }) {
  const joints = [...robot.joints].reverse(); // from the tail
  const obstacle = app.obstacle();
  const problems = useSignal<readonly CellProblem[]>([]);
  const problem = useSignal<string | null>(null);
  const longer = useSignal<JointPaste | null>(null); // waits for the answer whether joints are added
  const chosen = app.chosenJoints.peek()[0];
  // Another page has no such table.
  useEffect(
    () => () => {
      if (openDialog.peek() === 'joint_table') openDialog.value = 'none';
    },
    [],
  );

  useEffect(() => {
    const text = app.jointText.peek();
    app.jointText.value = null;
    if (text !== null) take(text, rangeOf(first, first));
  }, [app.jointText.value]);
  const first = { row: chosen === undefined ? 0 : Math.max(0, joints.length - 1 - chosen), column: 0 };

  const send = async (change: JointPaste) => {
    longer.value = null;
    problem.value = await app.setJointTable(change);
  };
  const take = (text: string, range: CellRange) => {
    const change = pasteJoints(text, range, joints);
    problems.value = change.problems;
    problem.value = null;
    longer.value = change.missing > 0 ? change : null;
    if (change.missing === 0 && change.joints.length > 0) void send(change);
  };
  return (
    <Dialog title="Table of joints" isWide>
      <CellTable
        corner="from the tail"
        testId="joint-table"
        rows={joints.map(({ name }) => ({ text: name }))}
        columns={jointColumns.map(({ name, title, unit, help }) => ({ text: title, help, isText: name === 'name', ...(unit === '' ? {} : { unit }) }))}
        first={first}
        isReadOnly={({ row }) => obstacle !== null || joints[row]?.editable !== true}
        canPaste={obstacle === null}
        textOf={({ row, column }) => jointCellText(joints[row]!, column)}
        labelOf={({ row, column }) => `${jointColumns[column]!.title} of ${joints[row]!.name}`}
        copyText={(range) => copyJoints(joints, range)}
        type={(text, cell) => take(text, rangeOf(cell, cell))}
        paste={take}
        problems={problems.value}
      />
      {problem.value !== null && (
        <p class="problem" role="alert">
          Nothing was changed: {problem.value}
        </p>
      )}
      {longer.value !== null && <MoreJoints app={app} robot={robot} change={longer.value} add={() => void send(longer.value!)} />}
      <p class="hint">
        {obstacle ?? 'Paste fills from the chosen cell on and is one change; a row of titles says which column is which.'} Shift and the arrow
        keys choose a range, Ctrl + A all with titles.
      </p>
    </Dialog>
  );
}

// The text has more rows than the robot has joints.
function MoreJoints({ app, robot, change, add }: { app: MakeApp; robot: DraftRobot; change: JointPaste; add(): void }) {
  const most = app.page.state.parts.value?.most_joints ?? 0;
  const count = robot.joints.length + change.missing;
  const rows = `${change.missing} more ${change.missing === 1 ? 'row' : 'rows'} than joints from the chosen one on`;
  const obstacle = robot.obstacle !== null ? `joints cannot be added: ${robot.obstacle}` : count > most ? `a robot has at most ${most} joints` : null;
  return (
    <div class="problem" role="alert">
      <p>
        Nothing was changed: the text has {rows}
        {obstacle === null ? '.' : `, and ${obstacle}`}
      </p>
      {obstacle === null && (
        <button type="button" onClick={add}>
          Add {change.missing} {change.missing === 1 ? 'joint' : 'joints'} at the head and paste
        </button>
      )}
    </div>
  );
}
