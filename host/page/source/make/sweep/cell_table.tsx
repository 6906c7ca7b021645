// The values of a sweep as a table: the best first, or in the order of the sweep.
import { useSignal } from '@preact/signals';
import type { OpenedSweep } from '../../wire/messages.js';
import { TableHead } from '../../panels/table_head.js';
import { countText, shortNumber } from '../search/search_text.js';
import type { ChosenSweep } from './chosen_sweep.js';
import { cellQuantities, placesOf, type Cells } from './sweep_cells.js';
import { cellName } from './sweep_text.js';

const fewRows = 100; // until more are wanted
const mostRows = 2000;

function inOrderOfMeans({ mean }: Cells, higherIsBetter: boolean): number[] {
  const key = (cell: number) => (Number.isNaN(mean[cell]!) ? Infinity : higherIsBetter ? -mean[cell]! : mean[cell]!);
  return Array.from(mean.keys()).sort((a, b) => (key(a) === key(b) ? a - b : key(a) - key(b)));
}

export function CellTable({ chosen, opened, cells, title, higherIsBetter }: { chosen: ChosenSweep; opened: OpenedSweep; cells: Cells; title: string; higherIsBetter: boolean }) {
  const isBestFirst = useSignal(true);
  const isLong = useSignal(false);
  const quantities = cellQuantities(opened);
  const all = isBestFirst.value ? inOrderOfMeans(cells, higherIsBetter) : Array.from(cells.mean.keys());
  const shown = all.slice(0, isLong.value ? mostRows : fewRows);
  const titles = [...quantities.map(({ name, unit }) => (unit === '' ? name : `${name} (${unit})`)), title, 'standard deviation', 'values', 'without'];
  return (
    <>
      <div class="fields" role="group" aria-label="Order of the table">
        {[true, false].map((isWanted) => (
          <button key={String(isWanted)} type="button" aria-pressed={isBestFirst.value === isWanted} onClick={() => (isBestFirst.value = isWanted)}>
            {isWanted ? 'The best first' : 'In order'}
          </button>
        ))}
      </div>
      <div class="table-frame candidates" tabIndex={0} role="group" aria-label="Table of cells">
        <table data-testid="cells">
          <caption class="hint">
            {countText(shown.length)} of {countText(all.length)} cells. Choose one to see how it moves.
          </caption>
          <TableHead titles={['cell', ...titles]} />
          <tbody>
            {shown.map((cell) => {
              const places = placesOf(quantities, cell);
              const number = (value: number) => (Number.isNaN(value) ? '–' : shortNumber(value));
              return (
                <tr key={cell} class={chosen.number.value === cell ? 'chosen' : ''} onClick={() => chosen.choose(cell)}>
                  <th scope="row">
                    <button type="button" aria-pressed={chosen.number.value === cell} aria-label={`Show ${cellName(opened, cell)}`}>
                      {cell + 1}
                    </button>
                  </th>
                  {quantities.map(({ name, values }, i) => (
                    <td key={name}>{values[places[i]!]}</td>
                  ))}
                  <td>{number(cells.mean[cell]!)}</td>
                  <td>{number(cells.deviation[cell]!)}</td>
                  <td>{cells.values[cell]}</td>
                  <td class={cells.failed[cell]! > 0 ? 'problem' : ''}>{cells.failed[cell]}</td>
                </tr>
              );
            })}
          </tbody>
        </table>
      </div>
      {all.length > fewRows && (
        <button type="button" aria-pressed={isLong.value} onClick={() => (isLong.value = !isLong.value)}>
          {all.length > mostRows ? `${countText(mostRows)} cells` : `All ${countText(all.length)} cells`}
        </button>
      )}
    </>
  );
}
