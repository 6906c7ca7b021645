// The joints of a draft as a table, as a spreadsheet has it: a row for each joint from the tail to the head.
import { formatNumber, parseNumber } from '../state/parameter_values.js';
import { type CellProblem, type CellRange, splitCells } from '../state/value_table.js';
import type { DraftJoint, JointValues } from '../wire/messages.js';
import { axisAngle, axisOfAngle } from '../state/robot_text.js';

type ColumnName = 'name' | 'axis' | 'lower' | 'upper' | 'torque' | 'speed';

interface Column {
  name: ColumnName;
  title: string;
  unit: string;
  help: string;
  alsoNamed: readonly string[]; // in a row of titles
}

export const jointColumns: readonly Column[] = [
  { name: 'name', title: 'name', unit: '', help: 'The name of the joint', alsoNamed: ['joint'] },
  { name: 'axis', title: 'axis', unit: '°', help: '0 or pitch, 90 or yaw, or an angle between them', alsoNamed: [] },
  { name: 'lower', title: 'lowest angle', unit: '°', help: 'Where the joint stops', alsoNamed: ['lower', 'lower limit', 'lowest', 'minimum', 'min'] },
  { name: 'upper', title: 'highest angle', unit: '°', help: 'Where the joint stops', alsoNamed: ['upper', 'upper limit', 'highest', 'maximum', 'max'] },
  { name: 'torque', title: 'torque', unit: 'Nm', help: 'How strong the servo is', alsoNamed: ['max torque'] },
  { name: 'speed', title: 'speed', unit: 'rad/s', help: 'How fast the servo turns at most', alsoNamed: ['max speed', 'velocity'] },
];

// Either the values of joints, or what is wrong; then nothing may take effect.
export interface JointPaste {
  joints: JointValues[];
  problems: CellProblem[];
  missing: number; // joints that the text has more than the robot
}

export function jointCellText(joint: DraftJoint, column: number): string {
  switch (jointColumns[column]?.name) {
    case 'name':
      return joint.name;
    case 'axis': {
      const angle = axisAngle(joint.axis);
      return angle === null ? joint.axis.join(' ') : formatNumber(angle, 2);
    }
    case 'lower':
      return formatNumber(joint.limits[0], 3);
    case 'upper':
      return formatNumber(joint.limits[1], 3);
    case 'torque':
      return formatNumber(joint.torque, 4);
    case 'speed':
      return formatNumber(joint.speed, 4);
    default:
      return '';
  }
}

// The cells of a range; all columns have a row of titles. joints: from the tail.
export function copyJoints(joints: readonly DraftJoint[], { from, to }: CellRange): string {
  const columns = jointColumns.map((_, column) => column).slice(from.column, to.column + 1);
  const lines = joints.slice(from.row, to.row + 1).map((joint) => columns.map((column) => jointCellText(joint, column)));
  const titles = jointColumns.map(({ title, unit }) => (unit === '' ? title : `${title} (${unit})`));
  return [...(columns.length === jointColumns.length ? [titles] : []), ...lines].map((cells) => cells.join('\t')).join('\n');
}

// An axis in words, as an angle, or as a direction: "pitch", "30°", "1 0 0.5".
function parseAxis(text: string): [number, number, number] | string {
  const word = text.trim().toLowerCase();
  if (word === 'pitch' || word === 'p') return axisOfAngle(0);
  if (word === 'yaw' || word === 'y') return axisOfAngle(90);
  const parts = word.split(/\s+/).map(parseNumber);
  const [x, y, z] = parts;
  if (parts.length === 3 && typeof x === 'number' && typeof y === 'number' && typeof z === 'number') return [x, y, z];
  const angle = parseNumber(word.replace(/\s*(°|deg|degrees?)$/, ''));
  return typeof angle === 'number' ? axisOfAngle(angle) : `found '${text.trim()}', expected pitch, yaw, or an angle in degrees`;
}

// The column with a title, which may have its unit behind it: "torque (Nm)". -1: there is none.
function columnOf(title: string): number {
  const word = title.replace(/[([/].*$/, '').replace(/\s+in\s.*$/i, '').replace(/_/g, ' ').trim().toLowerCase();
  return jointColumns.findIndex((column) => column.title === word || column.alsoNamed.includes(word));
}

function isTitles(cells: readonly string[]): boolean {
  return cells.some((cell) => columnOf(cell) >= 0) && cells.every((cell) => typeof parseNumber(cell) === 'string');
}

// The change by a text that is pasted at the first cell of the range. With a row of titles these say which column is which,
// else the columns begin with that of the cell. One value fills the range. An empty cell of the text leaves the value as it
// is. joints: from the tail.
export function pasteJoints(text: string, { from, to }: CellRange, joints: readonly DraftJoint[]): JointPaste {
  const problems: CellProblem[] = [];
  const lines = splitCells(text);
  while (lines.length > 1 && lines.at(-1)?.every((cell) => cell.trim() === '') === true) lines.pop();
  const hasTitles = lines.length > 1 && isTitles(lines[0] as string[]);
  const titles = hasTitles ? (lines.shift() as string[]) : null;
  const columns = titles?.map(columnOf) ?? null;
  columns?.forEach((column, i) => {
    const title = titles?.[i]?.trim() ?? '';
    const isTwice = column >= 0 && columns.indexOf(column) < i;
    if (title !== '' && (column < 0 || isTwice)) {
      const expected = isTwice ? 'each column once' : jointColumns.map((known) => known.title).join(', ');
      problems.push({ row: -1, column: i, reason: `found '${title}' in the row of titles, column ${i + 1}, expected ${expected}` });
    }
  });
  const isOne = titles === null && lines.length === 1 && lines[0]?.length === 1;
  const filled = isOne
    ? Array.from({ length: to.row - from.row + 1 }, () => Array.from({ length: to.column - from.column + 1 }, () => lines[0]?.[0] ?? ''))
    : lines;
  const missing = Math.max(0, from.row + filled.length - joints.length);
  const count = joints.length + missing;
  const changes: JointValues[] = [];
  filled.forEach((line, i) => {
    const row = from.row + i;
    const present = joints[row];
    const joint: JointValues = { joint: count - 1 - row };
    const limits: [number | null, number | null] = [present?.limits[0] ?? null, present?.limits[1] ?? null];
    let hasLimits = false;
    line.forEach((cell, j) => {
      const column = columns === null ? from.column + j : (columns[j] ?? -1);
      const name = jointColumns[column]?.name;
      const word = cell.trim();
      const fail = (reason: string) =>
        problems.push({ row, column, reason: `${reason} (row ${i + (titles === null ? 1 : 2)}, column ${j + 1} of the text)` });
      if (word === '' || (present !== undefined && word === jointCellText(present, column))) return;
      if (name === undefined) {
        if (columns === null || columns[j] === undefined) fail(`found '${word}', expected at most ${jointColumns.length - (columns === null ? from.column : 0)} columns`);
        return;
      }
      if (present?.editable === false) {
        fail(`${present.name} is in a file of its own, which other robots may use, too`);
      } else if (name === 'name') {
        joint.name = word;
      } else if (name === 'axis') {
        const axis = parseAxis(word);
        if (typeof axis === 'string') fail(axis);
        else joint.axis = axis;
      } else {
        const value = parseNumber(word);
        if (typeof value === 'string') fail(value);
        else if (name === 'lower' || name === 'upper') {
          limits[name === 'lower' ? 0 : 1] = value;
          hasLimits = true;
        } else joint[name] = value;
      }
    });
    const [lower, upper] = limits;
    if (hasLimits && lower !== null && upper !== null) joint.limits = [lower, upper];
    else if (hasLimits) problems.push({ row, column: lower === null ? 2 : 3, reason: 'found one limit of a new joint, expected both' });
    if (Object.keys(joint).length > 1) changes.push(joint);
  });
  return problems.length > 0 ? { joints: [], problems, missing: 0 } : { joints: changes, problems, missing };
}
