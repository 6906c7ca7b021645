// The table of bindings. A change takes effect when its field is left, or with Enter.
import { useSignal } from '@preact/signals';
import type { Stores } from '../view/robot_view.js';
import { formatNumber } from '../state/parameter_values.js';
import {
  actionBinding,
  actionTitles,
  parameterBinding,
  parameterNames,
  withNumber,
  type NumberField,
} from '../state/remote_bindings.js';
import type { RemoteBinding, RemoteDocument } from '../wire/messages.js';
import { closeIcon } from './icons.js';

const numberFields: readonly { field: NumberField; title: string }[] = [
  { field: 'lower', title: 'Lower' },
  { field: 'upper', title: 'Upper' },
  { field: 'step', title: 'Step' },
  { field: 'dead_zone', title: 'Dead zone' },
  { field: 'curve', title: 'Curve' },
];

type Change = (binding: RemoteBinding) => Promise<unknown>;

// A text field that shows the program's value again after a refusal.
function Field(props: { label: string; value: string; class?: string; isEnabled: boolean; commit: (text: string) => Promise<unknown> }) {
  const edited = useSignal<string | null>(null);
  const commit = async () => {
    if (edited.value !== null && edited.value !== props.value) {
      await props.commit(edited.value);
    }
    edited.value = null;
  };
  return (
    <input
      type="text"
      class={props.class}
      aria-label={props.label}
      value={edited.value ?? props.value}
      disabled={!props.isEnabled}
      onInput={(event) => (edited.value = event.currentTarget.value)}
      onBlur={() => void commit()}
      onKeyDown={(event) => {
        if (event.key === 'Enter') void commit();
      }}
    />
  );
}

function Target({ app, binding, change, isEnabled }: { app: Stores<'state'>; binding: RemoteBinding; change: Change; isEnabled: boolean }) {
  const choose = (choice: string) => {
    const parameter = app.state.parameters.value[0];
    if (choice !== '') {
      void change(actionBinding(binding, choice));
    } else if (parameter !== undefined) {
      void change(parameterBinding(binding, parameter));
    }
  };
  return (
    <select
      aria-label={`What ${binding.element} does`}
      value={binding.action ?? ''}
      disabled={!isEnabled}
      onChange={(event) => choose(event.currentTarget.value)}
    >
      <option value="">parameters</option>
      {Object.entries(actionTitles).map(([action, title]) => (
        <option key={action} value={action}>
          {title}
        </option>
      ))}
    </select>
  );
}

function ParameterFields({ app, binding, place, change, isEnabled }: { app: Stores<'state'>; binding: RemoteBinding; place: number; change: Change; isEnabled: boolean }) {
  const value = app.state.remoteValues.value?.bindings[place] ?? null;
  const isTaken = value?.taken.every(Boolean) === true;
  const setNumber = (field: NumberField, text: string) => {
    const changed = withNumber(binding, field, text);
    if (typeof changed !== 'string') {
      return change(changed);
    }
    app.state.addNotice('warning', changed);
    return Promise.resolve();
  };
  return (
    <div class="binding-fields">
      <label class="wide-field">
        <span>Parameters</span>
        <Field
          label={`Parameters of ${binding.element}`}
          value={(binding.parameters ?? []).join(' ')}
          isEnabled={isEnabled}
          commit={(text) => change({ ...binding, parameters: parameterNames(text) })}
        />
      </label>
      <label>
        <span>Method</span>
        <select aria-label={`Method of ${binding.element}`} value="linear" disabled={!isEnabled}>
          <option value="linear">linear</option>
        </select>
      </label>
      {numberFields.map(({ field, title }) => (
        <label key={field}>
          <span>{title}</span>
          <Field
            label={`${title} of ${binding.element}`}
            class="number-field"
            value={String(binding[field] ?? '')}
            isEnabled={isEnabled}
            commit={(text) => setNumber(field, text)}
          />
        </label>
      ))}
      <label title="No effect until it has passed the present value, so that the robot does not jump">
        <span>Take-up</span>
        <input
          type="checkbox"
          aria-label={`Soft take-up of ${binding.element}`}
          checked={binding.take_up ?? true}
          disabled={!isEnabled}
          onChange={(event) => void change({ ...binding, take_up: event.currentTarget.checked })}
        />
      </label>
      <output class={isTaken ? 'binding-value' : 'binding-value waits'}>
        {value === null ? '–' : `${formatNumber(value.value, 4)}${isTaken ? '' : ' (not taken up)'}`}
      </output>
    </div>
  );
}

export function RemoteBindingTable({ app, remote }: { app: Stores<'operations' | 'state'>; remote: RemoteDocument }) {
  const isHolder = app.state.isHolder.value;
  const { operations } = app;
  return (
    <div class="table-frame" tabIndex={0} role="group" aria-label="Table of bindings">
      <table class="bindings" data-testid="bindings">
        <thead>
          <tr>
            <th scope="col">Element</th>
            <th scope="col">Does</th>
            <th scope="col">How</th>
            <th scope="col" aria-label="Remove" />
          </tr>
        </thead>
        <tbody>
          {remote.bindings.map((binding, place) => {
            const change: Change = (changed) => operations.tell('remote.bind', { place, binding: changed });
            return (
              <tr key={place}>
                <th scope="row" title={binding.device}>
                  {binding.element}
                  <span class="unit">{binding.device}</span>
                </th>
                <td>
                  <Target app={app} binding={binding} change={change} isEnabled={isHolder} />
                </td>
                <td>
                  {binding.action === undefined && (
                    <ParameterFields app={app} binding={binding} place={place} change={change} isEnabled={isHolder} />
                  )}
                </td>
                <td>
                  <button
                    type="button"
                    class="icon-button"
                    aria-label={`Remove the binding of ${binding.element}`}
                    disabled={!isHolder}
                    onClick={() => void operations.tell('remote.unbind', { place })}
                  >
                    {closeIcon}
                  </button>
                </td>
              </tr>
            );
          })}
        </tbody>
      </table>
    </div>
  );
}
