// The chosen candidate: its values beside those of the draft, its measures, and the way into the draft.
import type { Measure, SearchCandidate } from '../../wire/messages.js';
import { CandidateValues } from './candidate_values.js';
import type { ChosenSearch } from './chosen_search.js';
import type { SearchApp } from './search_app.js';
import { candidateRemarks, withUnit } from './search_text.js';

function Measures({ candidate, measures }: { candidate: SearchCandidate; measures: readonly Measure[] }) {
  const known = Object.entries(candidate.measures).filter(([, value]) => value !== null);
  if (known.length === 0) return null;
  return (
    <details>
      <summary>{known.length} measures</summary>
      <dl class="file-list measure-list">
        {known.map(([name, value]) => {
          const measure = measures.find((each) => each.name === name);
          return (
            <div key={name} title={measure?.help}>
              <dt>{name.replaceAll('_', ' ')}</dt>
              <dd>{withUnit(value, measure?.unit ?? '')}</dd>
            </div>
          );
        })}
      </dl>
    </details>
  );
}

// Whether the gait is real: what `proleg confirm` says.
function Confirmation({ app, chosen }: { app: SearchApp; chosen: ChosenSearch }) {
  const confirmation = chosen.confirmation.value;
  const obstacle = app.host.obstacle();
  const isRunning = confirmation === 'running';
  return (
    <>
      <div class="fields">
        <button
          type="button"
          disabled={obstacle !== null || isRunning}
          title={obstacle ?? 'Simulates it with a finer step, in the other engines and in 50 worlds that differ, and looks where its energy comes from'}
          onClick={() => void chosen.confirm()}
        >
          Is it real?
        </button>
        <span class="hint" role="status">
          {isRunning ? 'simulating in other engines and worlds …' : ''}
        </span>
      </div>
      {confirmation !== null && confirmation !== 'running' && (
        <div data-testid="confirmation">
          <p role="status">{confirmation.nothing_speaks_against ? 'Nothing speaks against this gait.' : 'It may live on an error of the physics:'}</p>
          <ul class="findings">
            {confirmation.findings.map(({ name, good, text }) => (
              <li key={name} class={good === false ? 'problem' : ''}>
                {good === null ? '–' : good ? 'ok' : 'doubt'}: {name}. {text}
              </li>
            ))}
          </ul>
        </div>
      )}
    </>
  );
}

export function CandidateView({ app, chosen }: { app: SearchApp; chosen: ChosenSearch }) {
  const number = chosen.number.value;
  const candidate = chosen.candidate.value;
  const opened = chosen.opened.value;
  const problem = chosen.candidateProblem.value;
  if (number === null || opened === null) return null;
  const scores = opened.objectives.map(({ name, unit }, i) => `${name.replaceAll('_', ' ')} ${withUnit(candidate?.scores[i] ?? null, unit, 7)}`);
  return (
    <section class="panel make-panel" aria-label="Candidate" data-testid="candidate">
      <h2>
        Candidate {number} of {chosen.name}
      </h2>
      {problem !== null && (
        <p class="problem" role="alert">
          {problem}
        </p>
      )}
      {candidate === null && problem === null && <p class="hint">Reading …</p>}
      {candidate !== null && (
        <>
          {candidate.failure === null && <p>{scores.join(', ')}</p>}
          {candidateRemarks(candidate, opened.has_baseline).map((remark) => (
            <p class="hint" key={remark}>
              {remark}
            </p>
          ))}
          <CandidateValues host={app.host} what="candidate" words={candidate.words} apply={() => void app.apply()} />
          {candidate.failure === null && <Confirmation app={app} chosen={chosen} />}
          <Measures candidate={candidate} measures={app.host.page.state.searchMethods.value?.measures ?? []} />
        </>
      )}
    </section>
  );
}
