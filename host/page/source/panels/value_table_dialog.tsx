// All values of parameters as a table, to copy from and to paste into.
import { useSignal } from '@preact/signals';
import type { Stores } from '../view/robot_view.js';
import { type CellProblem, type CellRange, cellText, copyText, paste, rangeOf, wantedOf } from '../state/value_table.js';
import type { Parameter } from '../wire/messages.js';
import { CellTable } from './cell_table.js';
import { Dialog } from './dialog.js';

function classOf(parameter: Parameter, joint: number): string {
  const i = parameter.joints.indexOf(joint);
  const isChanged = parameter.wanted[i] !== parameter.file[i];
  const isPending = parameter.wanted[i] !== parameter.confirmed[i];
  return [isChanged && 'changed', isPending && 'pending'].filter(Boolean).join(' ');
}

export function ValueTableDialog({ app }: { app: Stores<'newGesture' | 'sets' | 'state'> }) {
  const parameters = app.state.parameters.value;
  const joints = app.state.robot.value?.joints.map((joint) => joint.name) ?? [];
  const isHolder = app.state.isHolder.value;
  const problems = useSignal<readonly CellProblem[]>([]);

  const take = (text: string, where: CellRange) => {
    const change = paste(text, where, parameters, joints);
    problems.value = change.problems;
    if (change.words.length > 0) app.sets.set(change.words, app.newGesture());
  };
  const nameOf = (parameter: Parameter) => parameter.name.replace(/_/g, ' ');

  return (
    <Dialog title="Table of values" isWide>
      <CellTable
        corner="parameter"
        testId="value-table"
        rows={parameters.map((parameter) => ({ text: `${parameter.slot}. ${nameOf(parameter)}`, unit: parameter.unit, help: parameter.help }))}
        columns={joints.map((text) => ({ text }))}
        isReadOnly={({ row, column }) => !isHolder || wantedOf(parameters[row]!, column) === null}
        canPaste={isHolder}
        textOf={({ row, column }) => cellText(parameters[row]!, column)}
        labelOf={({ row, column }) => `${nameOf(parameters[row]!)} of ${joints[column]}`}
        classOf={({ row, column }) => classOf(parameters[row]!, column)}
        copyText={(range) => copyText(parameters, range)}
        type={(text, cell) => take(text, rangeOf(cell, cell))}
        paste={take}
        problems={problems.value}
      />
      <p class="hint">
        {isHolder ? 'Paste fills from the chosen cell on and is one change. ' : 'Changing needs control. '}
        Shift and the arrow keys choose a range, Ctrl + A all; copy and paste as in a spreadsheet.
      </p>
    </Dialog>
  );
}
