// All values of parameters as a table, to copy from and to paste into.
//   arrows, Enter: move     Shift and arrows: choose a range     Ctrl+A: all     type: change a value
import { useSignal } from '@preact/signals';
import { useRef } from 'preact/hooks';
import type { Stores } from '../view/robot_view.js';
import { type Cell, type CellProblem, cellText, contains, copyText, paste, rangeOf, wantedOf } from '../state/value_table.js';
import type { Parameter } from '../wire/messages.js';
import { Dialog } from './dialog.js';

const shownProblems = 8;

const moves: Record<string, [number, number]> = {
  ArrowUp: [-1, 0],
  ArrowDown: [1, 0],
  ArrowLeft: [0, -1],
  ArrowRight: [0, 1],
  Enter: [1, 0],
};

// Whether an arrow key would only move within the text.
function staysInText(input: HTMLInputElement, key: string): boolean {
  const isAllChosen = input.selectionStart === 0 && input.selectionEnd === input.value.length;
  const isAtEdge = input.selectionStart === input.selectionEnd && input.selectionStart === (key === 'ArrowLeft' ? 0 : input.value.length);
  return (key === 'ArrowLeft' || key === 'ArrowRight') && !isAllChosen && !isAtEdge;
}

function classOf(parameter: Parameter, joint: number, isChosen: boolean): string {
  const i = parameter.joints.indexOf(joint);
  const isChanged = parameter.wanted[i] !== parameter.file[i];
  const isPending = parameter.wanted[i] !== parameter.confirmed[i];
  return [isChanged && 'changed', isPending && 'pending', isChosen && 'chosen'].filter(Boolean).join(' ');
}

export function ValueTableDialog({ app }: { app: Stores<'newGesture' | 'sets' | 'state'> }) {
  const parameters = app.state.parameters.value;
  const joints = app.state.robot.value?.joints.map((joint) => joint.name) ?? [];
  const isHolder = app.state.isHolder.value;
  const frame = useRef<HTMLDivElement>(null);
  const current = useSignal<Cell>({ row: 0, column: 0 });
  const anchor = useSignal<Cell>({ row: 0, column: 0 });
  const typed = useSignal<(Cell & { text: string }) | null>(null);
  const problems = useSignal<readonly CellProblem[]>([]);
  const range = rangeOf(anchor.value, current.value);
  const isRange = range.from.row !== range.to.row || range.from.column !== range.to.column;

  const take = (text: string, where: typeof range) => {
    const change = paste(text, where, parameters, joints);
    problems.value = change.problems;
    if (change.words.length > 0) app.sets.set(change.words, app.newGesture());
  };
  const accept = () => {
    const cell = typed.value;
    typed.value = null;
    if (cell !== null) take(cell.text, rangeOf(cell, cell));
  };
  const goTo = (cell: Cell, keepsAnchor: boolean) => {
    const row = Math.max(0, Math.min(parameters.length - 1, cell.row));
    const column = Math.max(0, Math.min(joints.length - 1, cell.column));
    const input = frame.current?.querySelector<HTMLInputElement>(`[data-at="${row},${column}"]`);
    const from = anchor.value;
    input?.focus(); // moves both ends of the range
    input?.select();
    current.value = { row, column };
    if (keepsAnchor) anchor.value = from;
  };
  const onKey = (event: KeyboardEvent) => {
    const input = event.target as HTMLInputElement;
    const move = moves[event.key];
    if (move !== undefined && (event.shiftKey || !staysInText(input, event.key))) {
      accept();
      const [down, right] = move;
      goTo({ row: current.value.row + down, column: current.value.column + right }, event.shiftKey && event.key !== 'Enter');
    } else if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === 'a') {
      anchor.value = { row: 0, column: 0 };
      current.value = { row: parameters.length - 1, column: joints.length - 1 };
    } else {
      return;
    }
    event.preventDefault();
  };
  const onCopy = (event: ClipboardEvent) => {
    if (!isRange) return; // the browser copies the chosen text of the field
    event.clipboardData?.setData('text/plain', copyText(parameters, range));
    event.preventDefault();
  };
  const onPaste = (event: ClipboardEvent) => {
    event.preventDefault();
    typed.value = null;
    if (isHolder) take(event.clipboardData?.getData('text/plain') ?? '', range);
  };
  const reasonAt = (row: number, column: number) =>
    problems.value.find((problem) => problem.row === row && problem.column === column)?.reason;

  return (
    <Dialog title="Table of values" isWide>
      <div
        ref={frame}
        class="table-frame value-table"
        data-testid="value-table"
        onKeyDown={onKey}
        onCopy={onCopy}
        onPaste={onPaste}
      >
        <table>
          <thead>
            <tr>
              <th scope="col">parameter</th>
              {joints.map((joint) => (
                <th scope="col" key={joint}>
                  {joint}
                </th>
              ))}
            </tr>
          </thead>
          <tbody>
            {parameters.map((parameter, row) => (
              <tr key={`${parameter.slot}.${parameter.name}`}>
                <th scope="row" title={parameter.help}>
                  {parameter.slot}. {parameter.name.replace(/_/g, ' ')} <span class="unit">{parameter.unit}</span>
                </th>
                {joints.map((joint, column) => {
                  const reason = reasonAt(row, column);
                  const isTyped = typed.value?.row === row && typed.value.column === column;
                  const isDriven = wantedOf(parameter, column) !== null;
                  return (
                    <td key={joint}>
                      <input
                        type="text"
                        inputMode="decimal"
                        data-at={`${row},${column}`}
                        class={classOf(parameter, column, isRange && contains(range, row, column))}
                        tabIndex={row === current.value.row && column === current.value.column ? 0 : -1}
                        aria-label={`${parameter.name.replace(/_/g, ' ')} of ${joint}`}
                        aria-invalid={reason !== undefined}
                        title={reason}
                        readOnly={!isHolder || !isDriven}
                        value={isTyped ? typed.value?.text : cellText(parameter, column)}
                        onInput={(event) => (typed.value = { row, column, text: event.currentTarget.value })}
                        onBlur={accept}
                        onFocus={() => (current.value = anchor.value = { row, column })}
                      />
                    </td>
                  );
                })}
              </tr>
            ))}
          </tbody>
        </table>
      </div>
      {problems.value.length > 0 && (
        <div class="problem" role="alert">
          <p>Nothing was changed:</p>
          <ul>
            {problems.value.slice(0, shownProblems).map(({ row, column, reason }) => (
              <li key={`${row},${column}`}>
                {parameters[row]?.name.replace(/_/g, ' ') ?? 'outside'}, {joints[column] ?? 'outside'}: {reason}
              </li>
            ))}
            {problems.value.length > shownProblems && <li>{problems.value.length - shownProblems} more</li>}
          </ul>
        </div>
      )}
      <p class="hint">
        {isHolder ? 'Paste fills from the chosen cell on and is one change. ' : 'Changing needs control. '}
        Shift and the arrow keys choose a range, Ctrl + A all; copy and paste as in a spreadsheet.
      </p>
    </Dialog>
  );
}
