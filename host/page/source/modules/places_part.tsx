// Gives the modules their places in the robot: one joint moves on the table, and a person says which one it is.
import { useSignal } from '@preact/signals';
import { ScenePanel } from '../panels/scene_panel.js';
import { TableHead } from '../panels/table_head.js';
import type { ModuleJob, NodeChange } from '../wire/messages.js';
import { resultOf } from '../wire/module_messages.js';
import { JobButton, JobObstacle, TableFrame } from './job_controls.js';
import { isRunning, numberIn } from './job_text.js';
import { refText, serialText } from './module_rows.js';
import type { ModulesApp } from './modules_app.js';
import { PlaceList } from './place_list.js';
import { placedModules } from './place_answers.js';

const defaultAmplitude = '5'; // degrees

function Start({ app }: { app: ModulesApp }) {
  const amplitude = useSignal(defaultAmplitude);
  const degrees = numberIn(amplitude.value, 1, 30);
  const robot = app.modules.value?.robot ?? null;
  const problem = robot === null ? 'Open a scenario first, on the page Make: its robot says which places there are.' : typeof degrees === 'string' ? degrees : null;
  return (
    <>
      <p class="hint">
        One joint after the other moves by some degrees to each side; all others have no power. Look at the table, and click here the joint that has moved. At the
        end you see which node ids change, and say whether they shall. Modules without a node id get a free one first.
      </p>
      <div class="fields">
        <label class="number-field" title="How far a joint moves to each side: 1 to 30 degrees">
          <span>a joint moves by</span>
          <input type="text" inputMode="decimal" size={4} name="amplitude" autocomplete="off" aria-label="a joint moves by, in degrees" aria-invalid={typeof degrees === 'string'} value={amplitude.value} onInput={(event) => (amplitude.value = event.currentTarget.value)} />
          <span class="unit">°</span>
        </label>
        <JobButton
          app={app}
          isPrimary
          obstacle={problem}
          title="Joints move, one at a time. Keep hands away"
          run={() => void app.tell('modules.assign', { amplitude: typeof degrees === 'number' ? degrees : Number(defaultAmplitude) })}
        >
          Find the places
        </JobButton>
        {problem !== null && <span class="problem">{problem}</span>}
        <JobObstacle app={app} />
      </div>
    </>
  );
}

function Question({ app, job }: { app: ModulesApp; job: ModuleJob }) {
  const { question } = app.places;
  const asked = question.value;
  if (asked === null || asked.question !== 'joint') {
    const moves = job.latest.moves;
    return <p role="status">{moves === undefined ? 'The modules are looked for …' : `${refText(moves)} …`}</p>;
  }
  const stuck = job.latest.cannot_move?.serial === asked.serial ? job.latest.cannot_move.problem : null;
  const degrees = job.latest.moves?.serial === asked.serial ? job.latest.moves.degrees : null;
  return (
    <div class="place-question" role="status" data-testid="place-question">
      {stuck === null ? (
        <p class="instruction">
          <strong>Which joint moves?</strong> {refText(asked)}, {serialText(asked.serial)}
          {degrees !== null && `, by ${degrees}° to each side`}
        </p>
      ) : (
        <p class="instruction bad">
          <strong>
            {refText(asked)}, {serialText(asked.serial)} cannot move: {stuck}.
          </strong>{' '}
          If you know its joint, choose it all the same.
        </p>
      )}
    </div>
  );
}

function Agreement({ app, changes }: { app: ModulesApp; changes: readonly NodeChange[] }) {
  const { places } = app;
  const why = app.answers.obstacle.value;
  return (
    <div data-testid="agreement">
      <p class="instruction" role="status">
        <strong>{changes.length === 0 ? 'All modules have their node ids already.' : 'These node ids will change:'}</strong>
      </p>
      {changes.length > 0 && (
        <TableFrame label="Table of node ids that change">
          <table>
            <TableHead titles={['module', 'joint', 'node id now', 'then']} />
            <tbody>
              {changes.map(({ serial, from, to, joint }) => (
                <tr key={serial}>
                  <th scope="row" class="code-text">
                    {serialText(serial)}
                  </th>
                  <td>{joint ?? 'none of this robot'}</td>
                  <td>{from === 0 ? 'none' : from}</td>
                  <td>
                    <strong>{to}</strong>
                  </td>
                </tr>
              ))}
            </tbody>
          </table>
        </TableFrame>
      )}
      <div class="fields">
        <button type="button" class="primary large" disabled={why !== null} title={why ?? 'The modules store them, and restart'} onClick={() => places.answer('yes')}>
          Give them these node ids
        </button>
        <button type="button" disabled={why !== null} title={why ?? 'Nothing is changed'} onClick={() => places.answer('no')}>
          No
        </button>
      </div>
    </div>
  );
}

function Ended({ app, job }: { app: ModulesApp; job: ModuleJob }) {
  const joints = app.modules.value?.robot?.joints ?? [];
  const placed = placedModules(job);
  const missing = joints.filter(({ name }) => !placed.has(name)).map(({ name }) => name);
  if (resultOf(job, 'assign') === null) return null;
  if (job.status === 0) return <p class="verdict good">Each joint has its module.</p>;
  return missing.length > 0 ? <p class="verdict bad">No module was found for {missing.join(', ')}.</p> : null;
}

export function PlacesPart({ app }: { app: ModulesApp }) {
  const { places } = app;
  const job = places.run.value;
  const goesOn = job !== null && isRunning(job);
  const asked = places.question.value;
  const hasRobot = app.modules.value?.robot != null;
  return (
    <>
      {goesOn ? asked?.question === 'agree' ? <Agreement app={app} changes={asked.changes} /> : <Question app={app} job={job} /> : <Start app={app} />}
      {!goesOn && job !== null && <Ended app={app} job={job} />}
      {app.answers.refused.value !== null && asked?.question === 'joint' && (
        <p class="problem" role="alert">
          {app.answers.refused.value}
        </p>
      )}
      {hasRobot && (
        <div class="places">
          {app.page.shownPage.value === 'modules' && <ScenePanel app={places.view} />}
          <PlaceList app={app} />
        </div>
      )}
    </>
  );
}
