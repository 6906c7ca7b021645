// The chosen sweep, in the place of the maps: how far it is, its line or map, its best cell and its table.
import type { SweepEntry } from '../../wire/messages.js';
import { ChoiceField } from '../fields/choice_field.js';
import { MotionControls } from '../search/motion_controls.js';
import type { SearchHost } from '../search/search_host.js';
import { CellTable } from './cell_table.js';
import { sweepApp, type SweepApp } from './sweep_app.js';
import { seedCount } from './sweep_cells.js';
import { SweepPicture } from './sweep_picture.js';
import { progressText } from './sweep_text.js';

function Controls({ app, entry }: { app: SweepApp; entry: SweepEntry }) {
  const obstacle = app.host.obstacle();
  const isRunning = entry.state === 'running' || entry.state === 'stopping';
  return (
    <>
      {isRunning && (
        <button type="button" disabled={obstacle !== null || entry.state === 'stopping'} title={obstacle ?? 'It ends after the runs that are simulated now; all that are complete stay.'} onClick={() => void app.stop()}>
          Stop
        </button>
      )}
      {entry.state === 'interrupted' && (
        <button type="button" disabled={obstacle !== null} title={obstacle ?? 'Simulates the runs that are missing'} onClick={() => void app.resume()}>
          Continue
        </button>
      )}
    </>
  );
}

export function ChosenSweepView({ app: host }: { app: SearchHost }) {
  const app = sweepApp(host);
  const chosen = app.chosen.value;
  const entry = app.entry.value;
  if (chosen === null) return null;
  const opened = chosen.opened.value;
  const cells = chosen.cells.value;
  const measures = host.page.state.searchMethods.value?.measures ?? [];
  const name = chosen.measure.value ?? opened?.measure ?? '';
  const measure = measures.find((each) => each.name === name);
  const measured = { name, unit: measure?.unit ?? '', higherIsBetter: measure?.higher_is_better ?? true };
  const problem = chosen.problem.value ?? entry?.problem ?? null;
  const title = measured.unit === '' ? name : `${name} (${measured.unit})`;
  return (
    <section class="panel search-view" aria-label="Chosen sweep" data-testid="chosen-sweep">
      <div class="panel-head">
        <h2>{chosen.name}</h2>
        {opened !== null && (
          <span class="hint" title={opened.options}>
            {entry?.scenario}
            {seedCount(opened) > 1 ? `, ${seedCount(opened)} seeds each` : ''}
          </span>
        )}
        <span class="space" />
        <button type="button" onClick={() => app.choose(null)} title="The maps come back">
          Close
        </button>
      </div>
      {entry === undefined ? (
        <p class="hint" role="status">
          This sweep is not there any more.
        </p>
      ) : (
        <div class="fields">
          <span role="status" class="search-state" data-testid="sweep-state">
            {progressText(entry)}
          </span>
          <Controls app={app} entry={entry} />
        </div>
      )}
      {entry?.state === 'running' && <progress aria-label="Runs" max={entry.planned} value={Math.min(entry.made, entry.planned)} />}
      {[app.problem.value, problem].map(
        (text) =>
          text !== null && (
            <p class="problem" role="alert" key={text}>
              {text}
            </p>
          ),
      )}
      {opened !== null && (
        <>
          {opened.scenario_problem !== null && <p class="hint">{opened.scenario_problem}</p>}
          {measures.length > 0 && (
            <div class="fields">
              <ChoiceField
                label="measure"
                value={name}
                texts={Object.fromEntries(measures.map((each) => [each.name, each.name.replaceAll('_', ' ')]))}
                title={measure?.help ?? ''}
                isDisabled={false}
                commit={(next) => chosen.chooseMeasure(next)}
              />
            </div>
          )}
          {cells === null ? (
            <p class="hint">{problem === null ? 'Reading …' : ''}</p>
          ) : (
            <>
              <SweepPicture chosen={chosen} opened={opened} cells={cells} measure={measured} />
              <CellTable chosen={chosen} opened={opened} cells={cells} title={title} higherIsBetter={measured.higherIsBetter} />
            </>
          )}
        </>
      )}
      <MotionControls
        app={app.search}
        what={chosen.number.value === null ? null : `cell ${chosen.number.value + 1}`}
        hint="Choose a cell: the 3D view shows how it moves beside the present gait."
      />
    </section>
  );
}
