// The settings of modules in files of the project.
import { useSignal } from '@preact/signals';
import { TableHead } from '../panels/table_head.js';
import { resultOf } from '../wire/module_messages.js';
import type { JobResults } from '../wire/messages.js';
import { CheckBox, JobButton, JobObstacle, TableFrame } from './job_controls.js';
import type { ModulesApp } from './modules_app.js';

function SaveForm({ app }: { app: ModulesApp }) {
  const file = useSignal('table.params');
  const onlyChecked = useSignal(false);
  const checked = app.checkedList.value;
  const name = file.value.trim();
  const exists = app.modules.value?.settings.includes(name) === true;
  const obstacle = name === '' ? 'Write a name first.' : exists ? 'There is such a file: choose another name.' : null;
  return (
    <fieldset>
      <legend>Save</legend>
      <div class="fields">
        <label class="number-field">
          <span>new file</span>
          <input type="text" size={20} name="settings-file" autocomplete="off" spellcheck={false} value={file.value} onInput={(event) => (file.value = event.currentTarget.value)} />
        </label>
        <CheckBox label={checked === null ? 'only checked rows' : `only nodes ${checked}`} isDisabled={checked === null} isOn={onlyChecked.value && checked !== null} change={(isOn) => (onlyChecked.value = isOn)} />
        <JobButton
          app={app}
          title="Reads the settings of the modules, and writes them into a file of the project"
          obstacle={obstacle}
          run={() => void app.tell('modules.save', { file: name, nodes: (onlyChecked.peek() ? checked : null) ?? 'all' })}
        >
          Save
        </JobButton>
        {exists && <span class="hint">{obstacle}</span>}
      </div>
    </fieldset>
  );
}

function Differences({ result }: { result: JobResults['compare'] }) {
  const { differences, other_modules, without_gait } = result;
  return (
    <div data-testid="differences">
      {differences.length === 0 ? (
        <p class="verdict good">No difference.</p>
      ) : (
        <TableFrame label="Table of differences">
          <table>
            <caption>{differences.length === 1 ? '1 difference' : `${differences.length} differences`}</caption>
            <TableHead titles={['node', 'object', 'index', 'module has', 'file has']} />
            <tbody>
              {differences.map(({ node, object, name, found, wanted }) => (
                <tr key={`${node} ${object}`}>
                  <th scope="row">{node}</th>
                  <td>{name}</td>
                  <td class="code-text">{object}</td>
                  <td>{found}</td>
                  <td>{wanted}</td>
                </tr>
              ))}
            </tbody>
          </table>
        </TableFrame>
      )}
      {(other_modules ?? []).map((text) => (
        <p key={text} class="problem">
          {text}
        </p>
      ))}
      {(without_gait ?? []).length > 0 && <p class="hint">Without the parameters of a gait, as after a reset: node {without_gait.join(', ')}.</p>}
    </div>
  );
}

function FileForm({ app }: { app: ModulesApp }) {
  const files = app.modules.value?.settings ?? [];
  const chosen = useSignal<string | null>(null);
  const isStored = useSignal(true);
  const anyModule = useSignal(false);
  const file = chosen.value !== null && files.includes(chosen.value) ? chosen.value : (files[0] ?? null);
  const obstacle = file === null ? 'The project has no file with settings.' : null;
  const result = resultOf(app.lastOf('compare'), 'compare');
  return (
    <fieldset>
      <legend>Compare and load</legend>
      {file === null ? (
        <p class="hint">{obstacle}</p>
      ) : (
        <label class="number-field">
          <span>file</span>
          <select value={file} onChange={(event) => (chosen.value = event.currentTarget.value)}>
            {files.map((name) => (
              <option key={name}>{name}</option>
            ))}
          </select>
        </label>
      )}
      <div class="fields">
        <JobButton app={app} needsControl={false} obstacle={obstacle} title="Shows what differs. It only reads" run={() => void app.tell('modules.compare', { file: file ?? '' })}>
          Compare
        </JobButton>
        <JobButton
          app={app}
          obstacle={obstacle}
          title="Writes what differs into the modules"
          run={() => void app.tell('modules.load', { file: file ?? '', store: isStored.peek(), any_module: anyModule.peek() })}
        >
          Load
        </JobButton>
        <CheckBox label="keep in flash" title="Else the modules lose them at a reset" isOn={isStored.value} change={(isOn) => (isStored.value = isOn)} />
        <CheckBox label="also if the serial numbers differ" title="For modules that take the place of others" isOn={anyModule.value} change={(isOn) => (anyModule.value = isOn)} />
      </div>
      {result !== null && <Differences result={result} />}
    </fieldset>
  );
}

// What was saved or loaded last.
function Done({ app }: { app: ModulesApp }) {
  const saved = resultOf(app.job.value, 'save');
  const loaded = resultOf(app.job.value, 'load');
  const count = (number: number, what: string) => `${number} ${what}${number === 1 ? '' : 's'}`;
  const text =
    saved !== null
      ? `The settings of ${count(saved.modules.length, 'module')} are saved.`
      : loaded !== null && typeof loaded.changed === 'number'
        ? `${count(loaded.changed, 'value')} changed${loaded.stored ? ', and kept in flash' : '; lost at the next reset'}.`
        : null;
  return text === null ? null : (
    <p class="verdict good" role="status">
      {text}
    </p>
  );
}

export function SettingsPart({ app }: { app: ModulesApp }) {
  return (
    <>
      <p class="hint">What modules keep in flash, but for the node id, and the parameters of their algorithms.</p>
      <SaveForm app={app} />
      <FileForm app={app} />
      <Done app={app} />
      <JobObstacle app={app} />
    </>
  );
}
