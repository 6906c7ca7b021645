// The part Search of the page Make: the searches, the form of a new one, and the chosen candidate.
import { useSignal } from '@preact/signals';
import type { ExperimentFile, SearchEntry } from '../../wire/messages.js';
import { DocumentationLink } from '../../panels/documentation_link.js';
import { TableHead } from '../../panels/table_head.js';
import { CandidateView } from './candidate_view.js';
import { searchApp, type SearchApp } from './search_app.js';
import { SearchForm } from './search_form.js';
import type { SearchHost } from './search_host.js';
import { durationText, evaluationsText, isRead, stateText, withUnit } from './search_text.js';

export { ChosenSearchView } from './chosen_search_view.js';

const fewSearches = 20; // in the list, until all are wanted

function SearchRow({ app, entry }: { app: SearchApp; entry: SearchEntry }) {
  const isChosen = app.host.chosenSearch.value === entry.name;
  return (
    <tr class={isChosen ? 'chosen' : ''}>
      <th scope="row">
        <button type="button" aria-pressed={isChosen} title={isRead(entry) ? `${entry.method} on ${entry.scenario}, ${new Date(entry.started).toLocaleString()}` : entry.name} onClick={() => app.choose(isChosen ? null : entry.name)}>
          {entry.name.replace(/^searches\//, '')}
        </button>
      </th>
      <td title={entry.problem ?? entry.ending ?? ''}>{entry.problem === null ? stateText(entry) : `${stateText(entry)} (!)`}</td>
      <td>{isRead(entry) ? evaluationsText(entry) : ''}</td>
      <td title={entry.objective}>{withUnit(entry.score, entry.unit)}</td>
      <td>{entry.left_s === null ? '' : durationText(entry.left_s)}</td>
    </tr>
  );
}

function SearchList({ app }: { app: SearchApp }) {
  const isLong = useSignal(false);
  const document = app.host.page.state.searches.value;
  if (document === null) return <p class="hint">Looking for searches …</p>;
  const { searches } = document;
  if (searches.length === 0) return <p class="hint">There is no search yet.</p>;
  const chosen = app.host.chosenSearch.value;
  const shown = isLong.value ? searches : searches.filter(({ name }, place) => place < fewSearches || name === chosen);
  return (
    <>
      <div class="table-frame" tabIndex={0} role="group" aria-label="Table of searches">
        <table data-testid="searches">
          <TableHead titles={['search', 'state', 'evaluations', 'best', 'left']} />
          <tbody>
            {shown.map((entry) => (
              <SearchRow key={entry.name} app={app} entry={entry} />
            ))}
          </tbody>
        </table>
      </div>
      {searches.length > fewSearches && (
        <button type="button" aria-pressed={isLong.value} onClick={() => (isLong.value = !isLong.value)}>
          All {searches.length} searches
        </button>
      )}
    </>
  );
}

function FileRow({ app, experiment }: { app: SearchApp; experiment: ExperimentFile }) {
  const { file, title } = experiment;
  const obstacle = app.host.obstacle();
  const failed = useSignal<string | null>(null);
  const read = async () => {
    failed.value = await app.form.read(file);
    if (failed.peek() === null) app.form.isOpen.value = true;
  };
  return (
    <li>
      <span class="file-title" title={file}>
        {title}
        {experiment.is_shipped ? ' (ships with Proleg)' : ''}
      </span>
      <button type="button" title="Its search for the draft, to be changed" onClick={() => void read()}>
        Into the form
      </button>
      <button type="button" disabled={obstacle !== null} title={obstacle ?? 'As it is, for the scenario that it names'} onClick={() => void app.startFile(file, title).then((refusal) => (failed.value = refusal))}>
        Start
      </button>
      {failed.value !== null && (
        <span class="problem" role="alert">
          {failed.value}
        </span>
      )}
    </li>
  );
}

export function SearchPart({ app: host }: { app: SearchHost }) {
  const app = searchApp(host);
  const { form } = app;
  const isShowingFiles = useSignal(false);
  const files = host.page.state.searches.value?.experiments ?? [];
  const chosen = app.chosen.value;
  return (
    <>
      <section class="panel make-panel" aria-label="Search">
        <h2>Search</h2>
        <p class="hint">A search tries many values of parameters, and finds those with which the robot rates best. It goes on when this page is closed. <DocumentationLink state={host.page.state} to="optimisation.html">How to search</DocumentationLink></p>
        <SearchList app={app} />
        <div class="fields">
          <button type="button" class={form.isOpen.value ? '' : 'primary'} aria-pressed={form.isOpen.value} onClick={() => (form.isOpen.peek() ? (form.isOpen.value = false) : form.open())}>
            New search …
          </button>
          <button type="button" aria-expanded={isShowingFiles.value} disabled={files.length === 0} title={files.length === 0 ? 'There is no experiment file.' : 'Experiment files, *.optimise.xml'} onClick={() => (isShowingFiles.value = !isShowingFiles.value)}>
            From a file …
          </button>
        </div>
        {isShowingFiles.value && <p class="hint">Start takes a file as it is, with the engine that its scenario names; the file of a search, with the engine of that search.</p>}
        {isShowingFiles.value && (
          <ul class="objects" aria-label="Experiment files">
            {files.map((experiment) => (
              <FileRow key={experiment.file} app={app} experiment={experiment} />
            ))}
          </ul>
        )}
      </section>
      {form.isOpen.value && <SearchForm app={app} />}
      {chosen !== null && <CandidateView app={app} chosen={chosen} />}
    </>
  );
}
