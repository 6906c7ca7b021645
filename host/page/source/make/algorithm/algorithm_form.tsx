// The form of a new algorithm.
import { useSignal, type Signal } from '@preact/signals';
import type { AlgorithmForm, FormParameter, FormValue, UnitName } from '../../wire/messages.js';
import type { AlgorithmApp } from './algorithm_app.js';
import { fieldProblem, type FieldProblem } from '../fields/field_problem.js';
import { FormField } from '../fields/form_field.js';

const unitTexts: Record<UnitName, string> = {
  degree: 'angle (deg)',
  phase_degree: 'phase (deg)',
  hertz: 'frequency (Hz)',
  per_second: 'rate (1/s)',
  ratio: 'ratio',
  count: 'whole number',
};

const mostParameters = 16;
const mostValues = 20;

const newParameter: FormParameter = { name: '', unit: 'ratio', minimum: '0', default: '0.5', maximum: '1', help: '' };
const newValue: FormValue = { name: '', unit: 'ratio', help: '' };

function UnitField({ value, change }: { value: UnitName; change(unit: UnitName): void }) {
  return (
    <label class="number-field">
      <span>unit</span>
      <select value={value} onChange={(event) => change(event.currentTarget.value as UnitName)}>
        {(Object.keys(unitTexts) as UnitName[]).map((unit) => (
          <option key={unit} value={unit}>
            {unitTexts[unit]}
          </option>
        ))}
      </select>
    </label>
  );
}

// Rows of a list of the form, each with a button that removes it.
function Rows<Row extends { name: string; unit: UnitName }>({ title, list, rows, most, empty, fields, problem, change }: {
  title: string;
  list: 'parameters' | 'values';
  rows: readonly Row[];
  most: number;
  empty: Row;
  fields: readonly { key: keyof Row & string; label: string; size: number }[];
  problem: FieldProblem | null;
  change(rows: Row[]): void;
}) {
  const set = (place: number, part: Partial<Row>) => change(rows.map((row, i) => (i === place ? { ...row, ...part } : row)));
  return (
    <fieldset class="copies">
      <legend>{title}</legend>
      {rows.map((row, i) => (
        <div class="fields" key={i} role="group" aria-label={`${list === 'parameters' ? 'Parameter' : 'Internal value'} ${i + 1}`}>
          {fields.map(({ key, label, size }) =>
            key === 'unit' ? (
              <UnitField key={key} value={row.unit} change={(unit) => set(i, { unit } as Partial<Row>)} />
            ) : (
              <FormField
                key={key}
                name={`${list}.${i}.${key}`}
                label={label}
                value={row[key] as string}
                size={size}
                problem={problem}
                change={(text) => set(i, { [key]: text } as Partial<Row>)}
              />
            ),
          )}
          <button
            type="button"
            aria-label={`Remove ${row.name === '' ? 'this row' : row.name}`}
            onClick={() => change(rows.filter((_, other) => other !== i))}
          >
            ✕
          </button>
        </div>
      ))}
      <button type="button" disabled={rows.length >= most} onClick={() => change([...rows, { ...empty }])}>
        Add {list === 'parameters' ? 'a parameter' : 'an internal value'}
      </button>
      {problem?.field === list && (
        <span class="problem" role="alert">
          {problem.text}
        </span>
      )}
    </fieldset>
  );
}

const parameterFields = [
  { key: 'name', label: 'name', size: 16 },
  { key: 'unit', label: 'unit', size: 0 },
  { key: 'minimum', label: 'lowest', size: 5 },
  { key: 'default', label: 'default', size: 5 },
  { key: 'maximum', label: 'highest', size: 5 },
  { key: 'help', label: 'what it is', size: 40 },
] as const;

const valueFields = [
  { key: 'name', label: 'name', size: 16 },
  { key: 'unit', label: 'unit', size: 0 },
  { key: 'help', label: 'what it is', size: 40 },
] as const;

export function AlgorithmFormView({ app, first }: { app: AlgorithmApp; first: AlgorithmForm }) {
  const form: Signal<AlgorithmForm> = useSignal(first);
  const problem = useSignal<FieldProblem | null>(null);
  const id = useSignal(String(first.id));
  const set = (part: Partial<AlgorithmForm>) => (form.value = { ...form.value, ...part });
  const isShown = (field: string) => /^(name|id|help|parameters|values)$|\./.test(field);
  const write = async () => {
    const { name, help, parameters, values, touch } = form.peek();
    // What is no whole number is refused by the program, with its reason.
    const number = /^\d+$/.test(id.peek().trim()) ? Number(id.peek()) : -1;
    const comma = (text: string) => text.trim().replace(',', '.');
    const refusal = await app.create({
      name: name.trim(),
      id: number,
      help: help.trim(),
      touch,
      values,
      parameters: parameters.map((each) => ({ ...each, minimum: comma(each.minimum), default: comma(each.default), maximum: comma(each.maximum) })),
    });
    problem.value = refusal === null ? null : fieldProblem(refusal);
  };
  const obstacle = app.obstacle();
  return (
    <form
      class="object-form"
      data-testid="algorithm-form"
      onSubmit={(event) => {
        event.preventDefault();
        void write();
      }}
    >
      <p class="hint">
        The source begins as a travelling wave as long as there are amplitude, frequency and phase_difference; else every joint stays at 0 until you write
        what it does.
      </p>
      <div class="fields">
        <FormField name="name" label="name" value={form.value.name} size={24} problem={problem.value} change={(name) => set({ name })} />
        <FormField name="id" label="id (96 to 126)" value={id.value} size={4} problem={problem.value} change={(text) => (id.value = text)} />
        <FormField name="help" label="what it does" value={form.value.help} size={40} problem={problem.value} change={(help) => set({ help })} />
        <label class="switch">
          <input
            type="checkbox"
            checked={form.value.touch}
            onChange={(event) => set({ touch: event.currentTarget.checked })}
            onKeyDown={(event) => {
              if (event.key !== 'Enter') return; // Space is STOP
              event.preventDefault();
              set({ touch: !form.value.touch });
            }}
          />
          uses the touch sensors
        </label>
      </div>
      <Rows<FormParameter>
        title="Parameters"
        list="parameters"
        rows={form.value.parameters}
        most={mostParameters}
        empty={newParameter}
        fields={parameterFields}
        problem={problem.value}
        change={(parameters) => set({ parameters })}
      />
      <Rows<FormValue>
        title="Internal values: what a joint keeps from tick to tick"
        list="values"
        rows={form.value.values}
        most={mostValues}
        empty={newValue}
        fields={valueFields}
        problem={problem.value}
        change={(values) => set({ values })}
      />
      {problem.value !== null && !isShown(problem.value.field) && (
        <p class="problem" role="alert">
          {problem.value.text}
        </p>
      )}
      <div class="fields">
        <button
          type="submit"
          class="primary"
          disabled={obstacle !== null}
          title={obstacle ?? 'Writes its source, a test and a robot into a new folder'}
        >
          Write the source
        </button>
        <button type="button" onClick={() => (app.isMaking.value = false)}>
          Cancel
        </button>
      </div>
    </form>
  );
}
