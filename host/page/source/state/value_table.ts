// The values of all parameters as a table, as a spreadsheet has it: a row for each parameter, a column for each joint.
import type { Parameter } from '../wire/messages.js';
import { formatRaw, parseValue, setWord } from './parameter_values.js';

export interface Cell {
  row: number;
  column: number;
}

export interface CellRange {
  from: Cell;
  to: Cell;
}

export interface CellProblem extends Cell {
  reason: string;
}

// Either the words of the change, or a text that says what is wrong; then nothing may take effect.
export interface Paste {
  words: string[];
  problems: CellProblem[];
}

// The range with both cells, in either order.
export function rangeOf(a: Cell, b: Cell): CellRange {
  return {
    from: { row: Math.min(a.row, b.row), column: Math.min(a.column, b.column) },
    to: { row: Math.max(a.row, b.row), column: Math.max(a.column, b.column) },
  };
}

export function contains({ from, to }: CellRange, row: number, column: number): boolean {
  return row >= from.row && row <= to.row && column >= from.column && column <= to.column;
}

// The wanted value of a joint; null if the parameter's slot does not drive the joint.
export function wantedOf(parameter: Parameter, joint: number): number | null {
  return parameter.wanted[parameter.joints.indexOf(joint)] ?? null;
}

export function cellText(parameter: Parameter, joint: number): string {
  const raw = wantedOf(parameter, joint);
  return raw === null ? '' : formatRaw(raw, parameter);
}

// Tab-separated lines, as spreadsheets put them on the clipboard. A line end at the end is not another row.
export function splitCells(text: string): string[][] {
  return text
    .replace(/\r\n?/g, '\n')
    .replace(/\n$/, '')
    .split('\n')
    .map((line) => line.split('\t'));
}

export function copyText(parameters: readonly Parameter[], { from, to }: CellRange): string {
  return parameters
    .slice(from.row, to.row + 1)
    .map((parameter) => {
      const texts: string[] = [];
      for (let column = from.column; column <= to.column; column += 1) texts.push(cellText(parameter, column));
      return texts.join('\t');
    })
    .join('\n');
}

// The change by a text that is pasted at the first cell of the range. One value fills the range. An empty cell of the text
// leaves the value unchanged.
export function paste(text: string, { from, to }: CellRange, parameters: readonly Parameter[], joints: readonly string[]): Paste {
  const result: Paste = { words: [], problems: [] };
  const cells = splitCells(text);
  const isOne = cells.length === 1 && cells[0]?.length === 1;
  const filled = isOne ? new Array(to.row - from.row + 1).fill(new Array(to.column - from.column + 1).fill(cells[0]?.[0])) : cells;
  (filled as string[][]).forEach((line, i) =>
    line.forEach((cell, j) => {
      const row = from.row + i;
      const column = from.column + j;
      const parameter = parameters[row];
      const joint = joints[column];
      const fail = (reason: string) => result.problems.push({ row, column, reason });
      if (cell.trim() === '') {
        return;
      }
      if (parameter === undefined || joint === undefined) {
        const size = `${parameters.length} rows and ${joints.length} columns`;
        fail(`found ${cell.trim()} in row ${row + 1}, column ${column + 1}, expected at most ${size}`);
      } else if (wantedOf(parameter, column) === null) {
        fail(`found ${cell.trim()} for ${joint}, expected nothing: slot ${parameter.slot} does not drive it`);
      } else if (cell.trim() !== cellText(parameter, column)) {
        const value = parseValue(cell, parameter);
        if (typeof value === 'string') fail(value);
        else result.words.push(setWord(parameter, joint, value));
      }
    }),
  );
  return result.problems.length > 0 ? { words: [], problems: result.problems } : result;
}
