// A table of text fields, as a spreadsheet has it: what is chosen is copied and pasted as tab-separated text.
//   arrows, Enter: move     Shift and arrows: choose a range     Ctrl+A: all     type: change a value
import { useSignal } from '@preact/signals';
import { useRef } from 'preact/hooks';
import { type Cell, type CellProblem, type CellRange, contains, rangeOf } from '../state/value_table.js';

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

export interface Title {
  text: string;
  unit?: string;
  help?: string;
  isText?: boolean; // no numbers: the keyboard of a phone
}

interface Table {
  corner: string; // title of the column of titles
  rows: readonly Title[];
  columns: readonly Title[];
  first?: Cell; // that is chosen at first
  testId: string;
  isReadOnly(cell: Cell): boolean;
  canPaste: boolean;
  textOf(cell: Cell): string;
  labelOf(cell: Cell): string;
  classOf?(cell: Cell): string;
  copyText(range: CellRange): string;
  // Requests the change by a text that was typed into a cell, or pasted from the first cell of a range on.
  type(text: string, cell: Cell): void;
  paste(text: string, range: CellRange): void;
  problems: readonly CellProblem[]; // of the last change
}

export function CellTable(table: Table) {
  const { rows, columns, problems } = table;
  const frame = useRef<HTMLDivElement>(null);
  const current = useSignal<Cell>(table.first ?? { row: 0, column: 0 });
  const anchor = useSignal<Cell>(current.peek());
  const typed = useSignal<(Cell & { text: string }) | null>(null);
  const range = rangeOf(anchor.value, current.value);
  const isRange = range.from.row !== range.to.row || range.from.column !== range.to.column;

  const accept = () => {
    const cell = typed.value;
    typed.value = null;
    if (cell !== null) table.type(cell.text, cell);
  };
  const goTo = (cell: Cell, keepsAnchor: boolean) => {
    const row = Math.max(0, Math.min(rows.length - 1, cell.row));
    const column = Math.max(0, Math.min(columns.length - 1, cell.column));
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
      current.value = { row: rows.length - 1, column: columns.length - 1 };
    } else {
      return;
    }
    event.preventDefault();
  };
  const onCopy = (event: ClipboardEvent) => {
    event.stopPropagation();
    if (!isRange) return; // the browser copies the chosen text of the field
    event.clipboardData?.setData('text/plain', table.copyText(range));
    event.preventDefault();
  };
  const onPaste = (event: ClipboardEvent) => {
    event.preventDefault();
    event.stopPropagation();
    typed.value = null;
    if (table.canPaste) table.paste(event.clipboardData?.getData('text/plain') ?? '', range);
  };
  const reasonAt = (row: number, column: number) => problems.find((problem) => problem.row === row && problem.column === column)?.reason;

  return (
    <>
      <div ref={frame} class="table-frame value-table" data-testid={table.testId} onKeyDown={onKey} onCopy={onCopy} onPaste={onPaste}>
        <table>
          <thead>
            <tr>
              <th scope="col">{table.corner}</th>
              {columns.map(({ text, unit, help }) => (
                <th scope="col" key={text} title={help}>
                  {text} {unit !== undefined && <span class="unit">{unit}</span>}
                </th>
              ))}
            </tr>
          </thead>
          <tbody>
            {rows.map(({ text, unit, help }, row) => (
              <tr key={row}>
                <th scope="row" title={help}>
                  {text} {unit !== undefined && <span class="unit">{unit}</span>}
                </th>
                {columns.map((title, column) => {
                  const cell = { row, column };
                  const reason = reasonAt(row, column);
                  const isTyped = typed.value?.row === row && typed.value.column === column;
                  const classes = [table.classOf?.(cell), isRange && contains(range, row, column) && 'chosen'];
                  return (
                    <td key={title.text}>
                      <input
                        type="text"
                        inputMode={title.isText === true ? 'text' : 'decimal'}
                        data-at={`${row},${column}`}
                        class={classes.filter(Boolean).join(' ')}
                        tabIndex={row === current.value.row && column === current.value.column ? 0 : -1}
                        aria-label={table.labelOf(cell)}
                        aria-invalid={reason !== undefined}
                        title={reason}
                        readOnly={table.isReadOnly(cell)}
                        value={isTyped ? typed.value?.text : table.textOf(cell)}
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
      {problems.length > 0 && (
        <div class="problem" role="alert">
          <p>Nothing was changed:</p>
          <ul>
            {problems.slice(0, shownProblems).map(({ row, column, reason }) => (
              <li key={`${row},${column}`}>
                {rows[row]?.text ?? 'outside'}, {columns[column]?.text ?? 'outside'}: {reason}
              </li>
            ))}
            {problems.length > shownProblems && <li>{problems.length - shownProblems} more</li>}
          </ul>
        </div>
      )}
    </>
  );
}
