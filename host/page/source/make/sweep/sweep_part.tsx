// Sweeps, below the searches in the part Search of the page Make: the list, the form of a new one, and the chosen cell.
import { useSignal } from '@preact/signals';
import type { SweepEntry } from '../../wire/messages.js';
import { TableHead } from '../../panels/table_head.js';
import { CandidateValues } from '../search/candidate_values.js';
import type { SearchHost } from '../search/search_host.js';
import { durationText } from '../search/search_text.js';
import { sweepApp, type SweepApp } from './sweep_app.js';
import { SweepFormView } from './sweep_form.js';
import { cellName, runsText, stateText } from './sweep_text.js';

export { ChosenSweepView } from './chosen_sweep_view.js';

const fewSweeps = 20; // in the list, until all are wanted

function SweepRow({ app, entry }: { app: SweepApp; entry: SweepEntry }) {
  const isChosen = app.host.chosenSweep.value === entry.name;
  const isRead = entry.state !== 'unreadable';
  return (
    <tr class={isChosen ? 'chosen' : ''}>
      <th scope="row">
        <button type="button" aria-pressed={isChosen} title={isRead ? `${entry.scenario}, ${new Date(entry.started).toLocaleString()}` : entry.name} onClick={() => app.choose(isChosen ? null : entry.name)}>
          {entry.name.replace(/^sweeps\//, '')}
        </button>
      </th>
      <td title={entry.problem ?? ''}>{entry.problem === null ? stateText(entry) : `${stateText(entry)} (!)`}</td>
      <td>{isRead ? runsText(entry) : ''}</td>
      <td>{entry.quantities.map(({ name, count }) => `${name} (${count})`).join(', ')}</td>
      <td>{entry.left_s === null ? '' : durationText(entry.left_s)}</td>
    </tr>
  );
}

function SweepList({ app }: { app: SweepApp }) {
  const isLong = useSignal(false);
  const document = app.host.page.state.sweeps.value;
  if (document === null) return <p class="hint">Looking for sweeps …</p>;
  const { sweeps } = document;
  if (sweeps.length === 0) return <p class="hint">There is no sweep yet.</p>;
  const chosen = app.host.chosenSweep.value;
  const shown = isLong.value ? sweeps : sweeps.filter(({ name }, place) => place < fewSweeps || name === chosen);
  return (
    <>
      <div class="table-frame" tabIndex={0} role="group" aria-label="Table of sweeps">
        <table data-testid="sweeps">
          <TableHead titles={['sweep', 'state', 'runs', 'over', 'left']} />
          <tbody>
            {shown.map((entry) => (
              <SweepRow key={entry.name} app={app} entry={entry} />
            ))}
          </tbody>
        </table>
      </div>
      {sweeps.length > fewSweeps && (
        <button type="button" aria-pressed={isLong.value} onClick={() => (isLong.value = !isLong.value)}>
          All {sweeps.length} sweeps
        </button>
      )}
    </>
  );
}

function CellView({ app }: { app: SweepApp }) {
  const chosen = app.chosen.value;
  const opened = chosen?.opened.value ?? null;
  const number = chosen?.number.value ?? null;
  if (chosen === null || opened === null || number === null) return null;
  const cell = chosen.cell.value;
  const problem = chosen.cellProblem.value;
  const name = cellName(opened, number);
  return (
    <section class="panel make-panel" aria-label="Cell" data-testid="sweep-cell">
      <h2>
        {name} of {chosen.name}
      </h2>
      {problem !== null && (
        <p class="problem" role="alert">
          {problem}
        </p>
      )}
      {cell === null && problem === null && <p class="hint">Reading …</p>}
      {cell !== null && (
        <>
          {cell.failure !== null && <p class="hint">A run failed: {cell.failure}</p>}
          {cell.others.length > 0 && <p class="hint">{cell.others.join(', ')}: of the world and the start. Apply leaves them as they are.</p>}
          {cell.words.length > 0 && <CandidateValues host={app.host} what="cell" words={cell.words} apply={() => void app.apply(`${name} of ${chosen.name.split('/').at(-1) ?? ''}`)} />}
        </>
      )}
    </section>
  );
}

export function SweepPart({ app: host }: { app: SearchHost }) {
  const app = sweepApp(host);
  const { form } = app;
  return (
    <>
      <section class="panel make-panel" aria-label="Sweeps">
        <h2>Sweeps</h2>
        <p class="hint">A sweep simulates all combinations of the values of one or two quantities, and draws a line or a map. It goes on when this page is closed.</p>
        <SweepList app={app} />
        <div class="fields">
          <button type="button" aria-pressed={form.isOpen.value} onClick={() => (form.isOpen.peek() ? (form.isOpen.value = false) : form.open())}>
            New sweep …
          </button>
        </div>
      </section>
      {form.isOpen.value && <SweepFormView app={app} />}
      <CellView app={app} />
    </>
  );
}
