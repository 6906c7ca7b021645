// The lines in which two texts differ.

export interface LineChange {
  line: number; // of the new text, from 1; of a removed line: where it was
  kind: 'added' | 'removed';
  text: string;
}

const mostCells = 4e6; // of the table of the longest common subsequence

export function lineDiff(before: string, after: string): LineChange[] {
  const old = before.split('\n');
  const now = after.split('\n');
  let start = 0;
  while (start < old.length && start < now.length && old[start] === now[start]) start += 1;
  let oldEnd = old.length;
  let nowEnd = now.length;
  while (oldEnd > start && nowEnd > start && old[oldEnd - 1] === now[nowEnd - 1]) {
    oldEnd -= 1;
    nowEnd -= 1;
  }
  const rows = oldEnd - start;
  const columns = nowEnd - start;
  const changes: LineChange[] = [];
  const removed = (i: number, j: number) => changes.push({ line: start + j + 1, kind: 'removed', text: old[start + i] as string });
  const added = (j: number) => changes.push({ line: start + j + 1, kind: 'added', text: now[start + j] as string });
  if (rows * columns > mostCells) {
    for (let i = 0; i < rows; i += 1) removed(i, 0);
    for (let j = 0; j < columns; j += 1) added(j);
    return changes;
  }
  // lengths[i][j]: of the longest common subsequence of the lines from i and from j on.
  const width = columns + 1;
  const lengths = new Uint32Array((rows + 1) * width);
  const length = (i: number, j: number) => lengths[i * width + j] as number;
  const isSame = (i: number, j: number) => old[start + i] === now[start + j];
  for (let i = rows - 1; i >= 0; i -= 1) {
    for (let j = columns - 1; j >= 0; j -= 1) {
      lengths[i * width + j] = isSame(i, j) ? length(i + 1, j + 1) + 1 : Math.max(length(i + 1, j), length(i, j + 1));
    }
  }
  let i = 0;
  let j = 0;
  while (i < rows || j < columns) {
    if (i < rows && j < columns && isSame(i, j)) {
      i += 1;
      j += 1;
    } else if (i < rows && (j === columns || length(i + 1, j) >= length(i, j + 1))) {
      removed(i, j);
      i += 1;
    } else {
      added(j);
      j += 1;
    }
  }
  return changes;
}
