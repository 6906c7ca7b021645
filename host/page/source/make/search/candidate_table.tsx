// The best candidates of a search, by any column, with the scenario's own values and the chosen candidate.
import { useSignal } from '@preact/signals';
import type { OpenedSearch } from '../../wire/messages.js';
import { wasGivenUp } from '../../wire/search_messages.js';
import type { ChosenSearch, ShownRows } from './chosen_search.js';
import { sortedBy, type Ranking, type SortColumn } from './ranking.js';
import { shortNumber } from './search_text.js';

const fewColumns = 10; // of values, until all are wanted
const fewOfFront = 100; // candidates, until all are wanted

interface Sort {
  column: SortColumn;
  isDescending: boolean;
}

function ColumnHead({ title, column, sort, isFirstDescending, change }: {
  title: string;
  column: SortColumn;
  sort: Sort | null;
  isFirstDescending: boolean;
  change(sort: Sort): void;
}) {
  const isSorted = sort !== null && JSON.stringify(sort.column) === JSON.stringify(column);
  const order = !isSorted ? 'none' : sort.isDescending ? 'descending' : 'ascending';
  return (
    <th scope="col" aria-sort={order}>
      <button type="button" onClick={() => change({ column, isDescending: isSorted ? !sort.isDescending : isFirstDescending })}>
        {title}
        {isSorted && (sort.isDescending ? ' ↓' : ' ↑')}
      </button>
    </th>
  );
}

function remarkOf({ store, front }: ShownRows, { has_baseline: hasBaseline }: OpenedSearch, row: number, objective: number): string {
  const remarks = [
    ...(hasBaseline && row === 0 ? ['own values'] : []),
    ...(front?.rows.includes(row) ? ['front'] : []),
    ...(store.hasScore(row, objective) ? [] : ['failed']),
    ...(store.has(row, wasGivenUp) ? ['given up'] : []),
  ];
  return remarks.join(', ');
}

export function CandidateTable({ chosen, opened, rows, ranking }: { chosen: ChosenSearch; opened: OpenedSearch; rows: ShownRows; ranking: Ranking }) {
  const sort = useSignal<Sort | null>(null);
  const isWide = useSignal(false);
  const count = chosen.shownCount.value;
  const number = chosen.number.value;
  const { store, front } = rows;
  const isFront = front !== null && chosen.isFrontListed.value;
  const isLong = useSignal(false);
  const first = !isFront ? ranking.best : isLong.value ? front.rows : front.rows.slice(0, fewOfFront);
  const more = [...(opened.has_baseline && count > 0 ? [0] : []), ...(number !== null && number < count ? [number] : [])];
  const listed = [...new Set([...first, ...more])];
  const shown = sort.value === null ? listed : sortedBy(store, listed, sort.value.column, sort.value.isDescending);
  const dimensions = isWide.value ? opened.dimensions : opened.dimensions.slice(0, fewColumns);
  const change = (next: Sort) => (sort.value = next);
  return (
    <>
      {front !== null && (
        <div class="fields" role="group" aria-label="Candidates in the table">
          {[false, true].map((isWanted) => (
            <button key={String(isWanted)} type="button" aria-pressed={isFront === isWanted} onClick={() => (chosen.isFrontListed.value = isWanted)}>
              {isWanted ? 'Pareto front' : 'The best'}
            </button>
          ))}
        </div>
      )}
      <div class="table-frame candidates" tabIndex={0} role="group" aria-label="Table of candidates">
        <table data-testid="candidates">
          <caption class="hint">
            {isFront ? `The Pareto front: ${first.length} of ${front.rows.length} candidates` : `The ${ranking.best.length} best candidates`}. Choose one to see how it moves.
          </caption>
          <thead>
            <tr>
              <ColumnHead title="candidate" column={{ kind: 'number' }} sort={sort.value} isFirstDescending={false} change={change} />
              {opened.objectives.map(({ name, unit, maximise }, index) => (
                <ColumnHead key={name} title={unit === '' ? name : `${name} (${unit})`} column={{ kind: 'score', index }} sort={sort.value} isFirstDescending={maximise} change={change} />
              ))}
              {dimensions.map(({ name, unit }, index) => (
                <ColumnHead key={name} title={unit === '' ? name : `${name} (${unit})`} column={{ kind: 'value', index }} sort={sort.value} isFirstDescending={false} change={change} />
              ))}
            </tr>
          </thead>
          <tbody>
            {shown.map((row) => {
              const remark = remarkOf(rows, opened, row, ranking.objective);
              return (
                <tr key={row} class={row === number ? 'chosen' : ''} onClick={() => chosen.chooseCandidate(row)}>
                  <th scope="row">
                    <button type="button" aria-pressed={row === number}>
                      {row}
                    </button>
                    {remark !== '' && <span class="hint"> {remark}</span>}
                  </th>
                  {opened.objectives.map(({ name }, objective) => (
                    <td key={name}>{store.hasScore(row, objective) ? shortNumber(store.scoreOf(row, objective)) : '–'}</td>
                  ))}
                  {dimensions.map(({ name }, dimension) => (
                    <td key={name}>{shortNumber(store.valueOf(row, dimension))}</td>
                  ))}
                </tr>
              );
            })}
          </tbody>
        </table>
      </div>
      {isFront && front.rows.length > fewOfFront && (
        <button type="button" aria-pressed={isLong.value} onClick={() => (isLong.value = !isLong.value)}>
          All {front.rows.length} candidates
        </button>
      )}
      {opened.dimensions.length > fewColumns && (
        <button type="button" aria-pressed={isWide.value} onClick={() => (isWide.value = !isWide.value)}>
          All {opened.dimensions.length} values
        </button>
      )}
    </>
  );
}
