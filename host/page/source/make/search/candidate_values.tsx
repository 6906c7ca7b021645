// Values beside those of the draft, and the way into the draft: of a candidate of a search, or of a cell of a sweep.
import type { SearchHost } from './search_host.js';
import { wordValues } from './word_values.js';

// what: whose values they are.
export function CandidateValues({ host, what, words, apply }: { host: SearchHost; what: string; words: readonly string[]; apply(): void }) {
  const draft = host.draft.value;
  const { algorithms } = host.page.state;
  if (draft === null) return null;
  const values = wordValues(words, draft, algorithms.value);
  const isApplied = values.length > 0 && values.every(({ isSame }) => isSame);
  const obstacle = host.obstacle();
  return (
    <>
      <div class="table-frame">
        <table data-testid="candidate-values">
          <thead>
            <tr>
              <th scope="col">value</th>
              <th scope="col">{what}</th>
              <th scope="col">draft</th>
              <th scope="col">unit</th>
            </tr>
          </thead>
          <tbody>
            {values.map(({ name, unit, candidate: value, draft: present, isSame }) => (
              <tr key={name} class={isSame ? '' : 'differs'}>
                <th scope="row">{name}</th>
                <td>{value}</td>
                <td>{present === '' ? '–' : present}</td>
                <td>{unit}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </div>
      <div class="fields">
        <button
          type="button"
          class="primary"
          disabled={obstacle !== null || isApplied || values.length === 0}
          title={obstacle ?? (isApplied ? 'The draft has these values.' : 'Puts these values into the draft, as one change that can be undone')}
          onClick={apply}
        >
          Apply
        </button>
        <span class="hint" role="status">
          {isApplied ? 'The draft has these values. Save … shows the lines that change.' : ''}
        </span>
      </div>
    </>
  );
}
