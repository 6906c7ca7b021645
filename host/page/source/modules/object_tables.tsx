// The objects of a module in groups. What can be written has a form.
import { useSignal } from '@preact/signals';
import { TableHead } from '../panels/table_head.js';
import type { ObjectValue } from '../wire/messages.js';
import { CheckBox, TableFrame } from './job_controls.js';
import { unitOf, valueWithoutUnit, valueWord } from './job_text.js';
import type { ModulesApp } from './modules_app.js';

function ObjectForm({ app, value, close }: { app: ModulesApp; value: ObjectValue; close: () => void }) {
  const typed = useSignal(valueWithoutUnit(value.value));
  const isStored = useSignal(false);
  const problem = useSignal<string | null>(null);
  const isSending = useSignal(false);
  const obstacle = app.obstacle();
  const unit = unitOf(value.value);
  const write = async () => {
    isSending.value = true;
    problem.value = null;
    try {
      const text = await app.objects.write(value.object, valueWord(typed.peek()), isStored.peek());
      app.page.state.addNotice('info', text === '' ? `${value.name} is written.` : text);
      close();
    } catch (error) {
      problem.value = (error as Error).message;
    } finally {
      isSending.value = false;
    }
  };
  return (
    <form
      class="fields object-write"
      onSubmit={(event) => {
        event.preventDefault();
        if (obstacle === null && !isSending.peek()) void write();
      }}
    >
      <label class="number-field">
        <input
          type="text"
          size={10}
          autocomplete="off"
          spellcheck={false}
          aria-label={unit === '' ? value.name : `${value.name} in ${unit}`}
          aria-invalid={problem.value !== null}
          value={typed.value}
          onInput={(event) => (typed.value = event.currentTarget.value)}
        />
        <span class="unit">{unit}</span>
      </label>
      <CheckBox label="keep in flash" title="The module keeps all its settings over a reset" isOn={isStored.value} change={(isOn) => (isStored.value = isOn)} />
      <button type="submit" class="primary" disabled={obstacle !== null || isSending.value} title={obstacle ?? 'Writes the value'}>
        Write
      </button>
      <button type="button" onClick={close}>
        Close
      </button>
      {(problem.value ?? obstacle) !== null && (
        <span class={problem.value === null ? 'hint' : 'problem'} role={problem.value === null ? undefined : 'alert'}>
          {problem.value ?? obstacle}
        </span>
      )}
    </form>
  );
}

function ObjectRow({ app, value }: { app: ModulesApp; value: ObjectValue }) {
  const isOpen = useSignal(false);
  return (
    <tr data-object={value.object}>
      <th scope="row">
        {value.name}
        {value.help !== undefined && value.help !== '' && <span class="hint">{value.help}</span>}
      </th>
      <td class="code-text">{value.object}</td>
      <td>
        {isOpen.value ? (
          <ObjectForm app={app} value={value} close={() => (isOpen.value = false)} />
        ) : (
          <>
            <span class="object-value">{value.value}</span>
            {value.writable === true && (
              <button type="button" aria-label={`Change ${value.name}`} onClick={() => (isOpen.value = true)}>
                Change
              </button>
            )}
          </>
        )}
      </td>
    </tr>
  );
}

export function ObjectTables({ app }: { app: ModulesApp }) {
  const { objects } = app;
  const reading = objects.reading.value;
  return (
    <>
      <div class="fields">
        <label class="number-field">
          <span>find</span>
          <input type="search" size={16} name="find-object" value={objects.filter.value} onInput={(event) => (objects.filter.value = event.currentTarget.value)} />
        </label>
        <CheckBox
          label="all objects"
          isOn={objects.isAll.value}
          isDisabled={app.readObstacle.value !== null}
          change={(isOn) => {
            objects.isAll.value = isOn;
            void objects.read();
          }}
        />
        <span class="hint" role="status">
          {objects.isReading.value ? 'Reading …' : reading === null ? '' : `read at ${reading.at.toLocaleTimeString()}`}
        </span>
      </div>
      {objects.problem.value !== null && (
        <p class="problem" role="alert">
          {objects.problem.value}
        </p>
      )}
      {reading !== null && objects.groups.value.length === 0 && <p class="hint">No object has these words.</p>}
      {objects.groups.value.length > 0 && (
        <TableFrame label="Table of objects">
          <table class="object-table" data-testid="objects">
            <TableHead titles={['object', 'index', 'value']} />
            {objects.groups.value.map(({ name, values }) => (
              <tbody key={name}>
                <tr class="group">
                  <th scope="rowgroup" colSpan={3}>
                    {name}
                  </th>
                </tr>
                {values.map((value) => (
                  <ObjectRow key={`${reading?.node} ${value.object} ${value.name}`} app={app} value={value} />
                ))}
              </tbody>
            ))}
          </table>
        </TableFrame>
      )}
    </>
  );
}
