// The chosen search, in the place of the maps: how far it is, what it has found, its learning curve, its points and candidates.
import { useSignal } from '@preact/signals';
import type { OpenedSearch, SearchEntry } from '../../wire/messages.js';
import { CandidateTable } from './candidate_table.js';
import type { ChosenSearch } from './chosen_search.js';
import { MapView } from './map_view.js';
import { MotionControls } from './motion_controls.js';
import { searchApp, type SearchApp } from './search_app.js';
import { SearchCharts } from './search_charts.js';
import type { SearchHost } from './search_host.js';
import { countText, progressText, resultLines, resumeKind, withUnit } from './search_text.js';

function Controls({ app, entry }: { app: SearchApp; entry: SearchEntry }) {
  const evaluations = useSignal('');
  const obstacle = app.host.obstacle();
  const kind = resumeKind(entry);
  // As many again, unless another number is typed.
  const proposed = entry.planned === null ? '' : String(kind === 'with more' ? 2 * entry.planned : entry.planned);
  return (
    <>
      {(entry.state === 'running' || entry.state === 'stopping') && (
        <button type="button" disabled={obstacle !== null || entry.state === 'stopping'} title={obstacle ?? 'It ends after the evaluations that are computed now; what it has found stays.'} onClick={() => void app.stop()}>
          Stop
        </button>
      )}
      {kind !== 'none' && (
        <form
          class="fields"
          onSubmit={(event) => {
            event.preventDefault();
            const typed = evaluations.peek().trim();
            void app.resume(typed === '' && kind === 'with more' ? proposed : typed);
          }}
        >
          <label class="number-field" title="The search ends after so many.">
            <span>evaluations</span>
            <input
              type="text"
              inputMode="numeric"
              size={9}
              name="resume-evaluations"
              autocomplete="off"
              placeholder={proposed}
              value={evaluations.value}
              onInput={(event) => (evaluations.value = event.currentTarget.value)}
            />
          </label>
          <button type="submit" disabled={obstacle !== null} title={obstacle ?? 'Goes on where it has ended'}>
            Continue
          </button>
        </form>
      )}
    </>
  );
}

function Result({ chosen, opened }: { chosen: ChosenSearch; opened: OpenedSearch }) {
  const { result } = opened;
  if (result === null) return null;
  return (
    <div class="search-result" data-testid="search-result">
      {resultLines(result, opened).map((line) => (
        <p key={line}>{line}</p>
      ))}
      <p>
        <button type="button" onClick={() => chosen.chooseCandidate(result.best_number)}>
          Show the best
        </button>
      </p>
    </div>
  );
}

// A repetition, an objective, a candidate by its number.
function Choices({ chosen, opened }: { chosen: ChosenSearch; opened: OpenedSearch }) {
  return (
    <div class="fields">
      {opened.runs > 1 && (
        <label class="number-field">
          <span>repetition</span>
          <select value={String(chosen.run.value)} onChange={(event) => chosen.chooseRun(Number(event.currentTarget.value))}>
            {Array.from({ length: opened.runs }, (_, run) => (
              <option key={run} value={String(run)}>
                {run + 1}
              </option>
            ))}
          </select>
        </label>
      )}
      {opened.objectives.length > 1 && (
        <label class="number-field">
          <span>objective</span>
          <select value={String(chosen.objective.value)} onChange={(event) => (chosen.objective.value = Number(event.currentTarget.value))}>
            {opened.objectives.map(({ name }, number) => (
              <option key={name} value={String(number)}>
                {name}
              </option>
            ))}
          </select>
        </label>
      )}
      <form
        class="fields"
        onSubmit={(event) => {
          event.preventDefault();
          const typed = Number(new FormData(event.currentTarget).get('candidate'));
          if (Number.isInteger(typed) && typed >= 0) chosen.chooseCandidate(typed);
        }}
      >
        <label class="number-field" title="Any candidate, also one that is not in the table">
          <span>candidate</span>
          <input type="text" name="candidate" inputMode="numeric" size={7} autocomplete="off" />
        </label>
        <button type="submit">Show</button>
      </form>
    </div>
  );
}

export function ChosenSearchView({ app: host }: { app: SearchHost }) {
  const app = searchApp(host);
  const chosen = app.chosen.value;
  const entry = app.entry.value;
  if (chosen === null) return null;
  const opened = chosen.opened.value;
  const rows = chosen.rows.value;
  const ranking = chosen.ranking.value;
  const reading = rows?.reader.problem.value ?? null;
  const problem = chosen.problem.value ?? reading ?? entry?.problem ?? null;
  return (
    <section class="panel search-view" aria-label="Chosen search" data-testid="chosen-search">
      <div class="panel-head">
        <h2>{chosen.name}</h2>
        {opened !== null && (
          <span class="hint">
            {opened.method}, {opened.engine}
            {opened.trials > 1 ? `, ${opened.trials} trials each` : ''}, {opened.dimensions.length} {opened.dimensions.length === 1 ? 'value' : 'values'}, seed {opened.seed}
          </span>
        )}
        <span class="space" />
        <button type="button" onClick={() => app.choose(null)} title="The maps come back">
          Close
        </button>
      </div>
      {entry === undefined ? (
        <p class="hint" role="status">
          This search is not there any more.
        </p>
      ) : (
        <>
          <div class="fields">
            <span role="status" class="search-state" data-testid="search-state">
              {progressText(entry)}
              {entry.score !== null && `; best: ${withUnit(entry.score, entry.unit)} (candidate ${entry.best ?? '–'})`}
            </span>
            <Controls key={chosen.name} app={app} entry={entry} />
          </div>
          {entry.state === 'running' && entry.planned !== null && <progress aria-label="Evaluations" max={entry.planned} value={Math.min(entry.made, entry.planned)} />}
          {app.problem.value !== null && (
            <p class="problem" role="alert">
              {app.problem.value}
            </p>
          )}
        </>
      )}
      {problem !== null && (
        <p class="problem" role="alert">
          {problem}
        </p>
      )}
      {opened !== null && <Result chosen={chosen} opened={opened} />}
      {opened !== null && rows !== null && ranking !== null && (
        <>
          <MapView chosen={chosen} opened={opened} rows={rows} />
          <SearchCharts chosen={chosen} opened={opened} rows={rows} ranking={ranking} />
          <Choices chosen={chosen} opened={opened} />
          {chosen.shownCount.value >= rows.store.capacity && <p class="hint">The page shows the first {countText(rows.store.capacity)} evaluations.</p>}
          <CandidateTable chosen={chosen} opened={opened} rows={rows} ranking={ranking} />
        </>
      )}
      <MotionControls
        app={app}
        what={chosen.number.value === null ? null : `candidate ${chosen.number.value}`}
        hint="Choose a candidate: the 3D view shows how it moves beside the present gait."
      />
    </section>
  );
}
