// One parameter: a slider and a number for all joints, and a cell for each joint.
import { useSignal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import type { Stores } from '../view/robot_view.js';
import { formatRaw, parseValue, placeName, setWord, splitHelp, summarise } from '../state/parameter_values.js';
import type { Parameter } from '../wire/messages.js';
import { JointCells } from './joint_cells.js';
import { ParameterSentence, sentencesAreShown } from './parameter_sentence.js';
import { ParameterSlider } from './parameter_slider.js';

// Whether the modules run with the requested values.
function Confirmation({ parameter }: { parameter: Parameter }) {
  const { confirmed, tick } = summarise(parameter);
  const count = parameter.wanted.length;
  const isConfirmed = confirmed === count;
  return (
    <span
      class={`confirmation ${isConfirmed ? 'done' : 'pending'}`}
      data-testid={`confirmed-${parameter.slot}.${parameter.name}`}
      title={
        isConfirmed
          ? `All joints work with the wanted values, from tick ${tick} on.`
          : `${confirmed} of ${count} joints work with the wanted values.`
      }
    >
      {isConfirmed ? (tick > 0 ? `✓ tick ${tick}` : '✓') : `… ${confirmed} of ${count}`}
    </span>
  );
}

export function ParameterRow({ app, parameter }: { app: Stores<'newGesture' | 'selection' | 'sets' | 'state'>; parameter: Parameter }) {
  const isHolder = app.state.isHolder.value;
  const { isUniform, isChanged } = summarise(parameter);
  const gesture = useSignal(0);
  const typed = useSignal<string | null>(null); // until it is accepted; a text that was refused stays, to be corrected
  const problem = useSignal<string | null>(null);
  const helpIsOpen = useSignal(false);
  const id = `parameter-${parameter.slot}-${parameter.name}`;
  const title = parameter.name.replace(/_/g, ' ');

  const set = (value: number) => app.sets.set([setWord(parameter, null, value)], gesture.value);
  const reset = () => {
    typed.value = problem.value = null;
    app.sets.reset([placeName(parameter, null)]);
  };
  const mean = parameter.wanted.reduce((sum, raw) => sum + raw, 0) / Math.max(1, parameter.wanted.length);
  const first = parameter.wanted[0] ?? 0;
  const unit = parameter.unit === '' ? '' : ` ${parameter.unit}`;
  const fileText = [...new Set(parameter.file)].map((raw) => formatRaw(raw, parameter)).join(', ');

  const shown = isUniform ? formatRaw(first, parameter) : '';
  // What was refused is over when the value changes by other means.
  useEffect(() => {
    if (problem.peek() !== null) typed.value = problem.value = null;
  }, [shown]);

  const accept = () => {
    const text = typed.peek();
    if (text === null) return;
    const value = text.trim() === shown ? null : parseValue(text, parameter);
    problem.value = typeof value === 'string' ? value : null;
    if (typeof value === 'string') return;
    typed.value = null;
    if (value === null) return;
    gesture.value = app.newGesture();
    set(value);
  };

  return (
    <div class={`parameter ${isChanged ? 'changed' : ''}`} data-parameter={`${parameter.slot}.${parameter.name}`}>
      <div class="parameter-head">
        <button
          type="button"
          class="parameter-name"
          aria-expanded={helpIsOpen.value}
          onClick={() => (helpIsOpen.value = !helpIsOpen.value)}
          title={parameter.help}
        >
          {title}
        </button>
        {isChanged && <span class="file-value">file: {fileText.length > 24 ? 'several' : fileText}</span>}
        <span class="space" />
        <Confirmation parameter={parameter} />
      </div>
      <ParameterSentence help={parameter.help} id={`${id}-sentence`} />
      {helpIsOpen.value && (
        <p class="help">
          {sentencesAreShown.value ? splitHelp(parameter.help).details : parameter.help} From {formatRaw(parameter.minimum, parameter)} to {formatRaw(parameter.maximum, parameter)}
          {unit}; the default is {formatRaw(parameter.default, parameter)}. Double click: back to the file’s value.
        </p>
      )}
      <div class="parameter-body">
        <ParameterSlider
          parameter={parameter}
          value={mean * parameter.scale}
          label={`${title}, all joints`}
          describedBy={sentencesAreShown.value ? `${id}-sentence` : undefined}
          isDisabled={!isHolder}
          begin={() => (gesture.value = app.newGesture())}
          set={set}
          reset={reset}
        />
        <input
          type="text"
          inputMode="decimal"
          aria-label={`${title}, all joints, in ${parameter.unit || 'numbers'}`}
          aria-invalid={problem.value !== null}
          value={typed.value ?? shown}
          placeholder={isUniform ? '' : 'several'}
          disabled={!isHolder}
          onInput={(event) => (typed.value = event.currentTarget.value)}
          onBlur={accept}
          onKeyDown={(event) => {
            if (event.key === 'Enter') accept();
          }}
          onDblClick={reset}
        />
        <span class="unit">{parameter.unit}</span>
        <JointCells app={app} parameter={parameter} />
      </div>
      {problem.value !== null && (
        <p class="problem" role="alert" id={`${id}-problem`}>
          {problem.value}
        </p>
      )}
    </div>
  );
}
