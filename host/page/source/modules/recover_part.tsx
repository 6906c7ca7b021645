// Brings modules back that do not start, or have no node id of their own: first it says what is wrong, then it does it.
import { useSignal } from '@preact/signals';
import { DocumentationLink } from '../panels/documentation_link.js';
import { TableHead } from '../panels/table_head.js';
import type { PageState } from '../state/page_state.js';
import type { ModuleJob, ModuleRef, ModuleTrouble } from '../wire/messages.js';
import { resultOf } from '../wire/module_messages.js';
import { AdvanceCell } from './flash_table.js';
import { ImageChoice, imageOf } from './image_choice.js';
import { CheckBox, JobButton, JobObstacle, TableFrame } from './job_controls.js';
import { isRunning, numberIn, waitOf, waitText } from './job_text.js';
import { refText, serialText } from './module_rows.js';
import type { ModulesApp } from './modules_app.js';

const defaultWait = '8'; // seconds

interface RecoverRow extends ModuleRef {
  found: readonly ModuleTrouble[];
  end: { text: string; isGood: boolean } | null;
}

function rowsOf(job: ModuleJob | null): RecoverRow[] {
  const result = resultOf(job, 'recover');
  if (result === null) return (job?.kind === 'recover' ? (job.latest.found?.modules ?? []) : []).map((module) => ({ ...module, end: null }));
  return result.modules.map(({ serial, node, node_before, found, well, remains, problem, done, version, present }) => {
    const gone = 'answers no more: recover again, and switch the supply off and on while it waits';
    const rest = problem ?? (present ? remains.map(({ what, to_do }) => `${what}: ${to_do}`).join('; ') : gone);
    const moved = node_before !== node ? `; its node id was ${node_before === 0 ? 'none' : node_before}` : '';
    const text = well ? `well${done.length > 0 ? ' now' : ''}${version === null ? '' : `, ${version}`}${moved}` : rest;
    return { node, serial, found, end: result.dry_run && !well ? null : { text, isGood: well } };
  });
}

function RecoverTable({ app, job }: { app: ModulesApp; job: ModuleJob }) {
  const rows = rowsOf(job);
  const result = resultOf(job, 'recover');
  const known = app.flashAdvance.value;
  const advances = known?.job === job.number ? known.bySerial : new Map();
  return (
    <>
      {rows.length === 0 && result !== null && <p class="hint">No module was found.</p>}
      {rows.length > 0 && (
        <TableFrame label="Table of modules that are looked at">
          <table class="wrapped" data-testid="recovery">
            <TableHead titles={['module', 'serial number', 'what is wrong', 'what is done', 'state']} />
            <tbody>
              {rows.map(({ node, serial, found, end }) => (
                <tr key={serial}>
                  <th scope="row">{refText({ node, serial })}</th>
                  <td class="code-text">{serialText(serial)}</td>
                  <td class="text">{found.map(({ what }) => what).join('; ') || 'nothing'}</td>
                  <td class={`text ${found.some(({ by_hand }) => by_hand) ? 'module bad' : ''}`}>
                    {found.map(({ to_do, by_hand }) => `${to_do}${by_hand ? ' (by hand)' : ''}`).join('; ') || '–'}
                  </td>
                  {end !== null ? (
                    <td class={`text module ${end.isGood ? 'good' : 'bad'}`}>{end.text}</td>
                  ) : (
                    <AdvanceCell advance={advances.get(serial) ?? null} wait={isRunning(job) ? 'waits' : '–'} />
                  )}
                </tr>
              ))}
            </tbody>
          </table>
        </TableFrame>
      )}
      {result !== null && !result.dry_run && (
        <p class={result.well ? 'verdict good' : 'verdict bad'} role="status">
          {result.well ? 'All modules are well.' : 'Not all modules are well: the table says what remains.'}
        </p>
      )}
    </>
  );
}

// What a person does while it waits, and for how long yet.
function RecoverWait({ job, state }: { job: ModuleJob | null; state: PageState }) {
  const wait = waitOf(job);
  if (wait === null) return null;
  const { text, left } = waitText(wait);
  return (
    <div class="recover-wait" data-testid="recover-wait">
      <p class="announcement" role="status">
        <strong>If a module answers nothing at all, switch the robot’s supply off and on now.</strong> The adapter must keep its power.{' '}
        <DocumentationLink state={state} to="flashing.html#a-program-that-answers-nothing">
          Why
        </DocumentationLink>
      </p>
      <div class="fields">
        <progress aria-label="Time for this" max={wait.seconds} value={wait.seconds - wait.left_s} />
        <span>{left}</span>
        <span class="hint">{text}</span>
      </div>
    </div>
  );
}

export function RecoverPart({ app }: { app: ModulesApp }) {
  const chosen = useSignal<string | null>(null);
  const wait = useSignal(defaultWait);
  const resets = useSignal(false);
  const images = app.modules.value?.images ?? [];
  const image = imageOf(images, chosen.value);
  const seconds = numberIn(wait.value, 1, 600);
  const job = app.lastOf('recover');
  const wasLooked = resultOf(job, 'recover') !== null;
  const problem = image?.problem ?? (typeof seconds === 'string' ? seconds : null);
  const begin = (dryRun: boolean) =>
    void app.tell('modules.recover', {
      image: image?.file ?? null,
      wait: typeof seconds === 'number' ? seconds : Number(defaultWait),
      serials: [],
      reset_settings: resets.peek(),
      dry_run: dryRun,
    });
  return (
    <>
      <p class="hint">
        For modules that do not start, have no node id or that of another one, or are Stopped. A module that is well is left alone. Nothing shows that a module is
        missing, so it waits: a program that hangs is silent for five seconds at first. <DocumentationLink state={app.page.state} to="flashing.html#a-module-that-does-not-come-back">A module that does not come back</DocumentationLink>
      </p>
      <div class="fields">
        <ImageChoice app={app} chosen={chosen} none="without an image" />
        <label class="number-field" title="How long it looks for modules">
          <span>look for</span>
          <input type="text" inputMode="decimal" size={4} name="recover-wait" autocomplete="off" aria-label="look for, in seconds" aria-invalid={typeof seconds === 'string'} value={wait.value} onInput={(event) => (wait.value = event.currentTarget.value)} />
          <span class="unit">s</span>
          {typeof seconds === 'string' && (
            <span class="problem" role="alert">
              {seconds}
            </span>
          )}
        </label>
      </div>
      <div class="fields">
        <CheckBox label="reset settings that only a later program knows" isOn={resets.value} change={(isOn) => (resets.value = isOn)} />
      </div>
      {resets.value && <p class="announcement bad">Such a module loses its limits, its calibration and all other settings, but for its node id.</p>}
      <div class="fields">
        <JobButton app={app} isPrimary={!wasLooked} obstacle={problem} title="Says what is wrong with each module, and changes nothing" run={() => begin(true)}>
          {wasLooked ? 'Look again' : 'Look what is wrong'}
        </JobButton>
        <JobButton app={app} isPrimary={wasLooked} obstacle={problem ?? (wasLooked ? null : 'Look what is wrong first.')} title="Does what the table says" run={() => begin(false)}>
          Recover
        </JobButton>
        <JobObstacle app={app} />
      </div>
      <RecoverWait job={job} state={app.page.state} />
      {job !== null && <RecoverTable app={app} job={job} />}
    </>
  );
}
