// A joint that is dragged to another place of the chain. Columns are counted from the tail, places between them too: 0 is
// before the first one.

// The place that is nearest to the pointer. edges: left and right side of each column.
export function placeAt(x: number, columns: readonly { left: number; right: number }[]): number {
  return columns.filter(({ left, right }) => (left + right) / 2 < x).length;
}

// The column of a joint after it has gone from one column to a place.
export function columnAfter(from: number, place: number): number {
  return place > from ? place - 1 : place;
}

// How far a view that scrolls goes on in a step while something is dragged near one of its sides. Pixels.
export function scrollStep(x: number, view: { left: number; right: number }): number {
  const margin = 32;
  const step = 10;
  return x < view.left + margin ? -step : x > view.right - margin ? step : 0;
}
