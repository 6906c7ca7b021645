// What may change: the parameters of the actuation modules that the search chooses, and the values of each.
import { useSignal } from '@preact/signals';
import { formatRaw, splitHelp } from '../../state/parameter_values.js';
import { algorithmTitle, fromTail } from '../../state/robot_text.js';
import type { AlgorithmDocument, ChosenParameter, DraftDocument } from '../../wire/messages.js';
import { ChoiceField } from '../fields/choice_field.js';
import type { FieldProblem } from '../fields/field_problem.js';
import { FormField } from '../fields/form_field.js';
import { newParameter, parameterOf } from './experiment_defaults.js';
import { FieldAlert } from './field_alert.js';

interface Part {
  draft: DraftDocument;
  algorithms: readonly AlgorithmDocument[];
  problem: FieldProblem | null;
}

function moduleTitle(draft: DraftDocument, module: number): string {
  return `${module + 1}. ${algorithmTitle(draft.behaviour.modules[module]?.algorithm ?? 'module')}`;
}

function JointChoice({ draft, parameter, change }: { draft: DraftDocument; parameter: ChosenParameter; change(joints: number[]): void }) {
  const moved = draft.behaviour.modules[parameter.module]?.joints ?? [];
  const chosen = parameter.joints ?? [];
  return (
    <div class="fields" role="group" aria-label="Chosen joints">
      {fromTail(draft.robot.joints.length)
        .filter((joint) => moved.includes(joint))
        .map((joint) => (
          <button
            key={joint}
            type="button"
            aria-pressed={chosen.includes(joint)}
            onClick={() => change(chosen.includes(joint) ? chosen.filter((other) => other !== joint) : [...chosen, joint].sort((a, b) => a - b))}
          >
            {draft.robot.joints[joint]!.name}
          </button>
        ))}
    </div>
  );
}

const limitTexts = { inclusive: 'inclusive', exclusive: 'exclusive' } as const;

function ValueFields({ path, parameter, problem, unit, change }: {
  path: string;
  parameter: ChosenParameter;
  problem: FieldProblem | null;
  unit: string;
  change(part: Partial<ChosenParameter>): void;
}) {
  const each = parameter.same ? '' : ' One number for all joints, or one for each, in the order of the robot’s file.';
  if (parameter.set !== null) {
    return (
      <FormField
        name={`${path}.set`}
        label="values"
        unit={unit}
        value={parameter.set}
        size={30}
        problem={problem}
        title="Numbers with blanks between them: 0 10 20"
        change={(set) => change({ set })}
      />
    );
  }
  const limit = (name: 'lower' | 'upper', flag: 'with_lower' | 'with_upper') => (
    <>
      <FormField
        name={`${path}.${name}`}
        label={`${name} limit`}
        unit={unit}
        value={parameter[name]}
        size={8}
        isNumeric
        problem={problem}
        title={`The ${name === 'lower' ? 'lowest' : 'highest'} value.${each}`}
        change={(text) => change({ [name]: text })}
      />
      <ChoiceField
        label=""
        title={`Inclusive: the ${name} limit is one of the values.`}
        name={`${name} limit inclusive or exclusive`}
        value={parameter[flag] ? 'inclusive' : 'exclusive'}
        texts={limitTexts}
        isDisabled={false}
        commit={(value) => change({ [flag]: value === 'inclusive' })}
      />
    </>
  );
  return (
    <>
      {limit('lower', 'with_lower')}
      {limit('upper', 'with_upper')}
      <FormField
        name={`${path}.step`}
        label="step"
        unit={unit}
        value={parameter.step}
        size={6}
        isNumeric
        problem={problem}
        title={`From one value to the next. It must fit between the limits.${each}`}
        change={(step) => change({ step })}
      />
    </>
  );
}

function ParameterRow({ draft, algorithms, problem, number, parameter, change, remove }: Part & {
  number: number;
  parameter: ChosenParameter;
  change(part: Partial<ChosenParameter>): void;
  remove(): void;
}) {
  const module = draft.behaviour.modules[parameter.module];
  const declared = parameterOf(algorithms, module, parameter.parameter);
  const path = `parameters.${number}`;
  const title = `${moduleTitle(draft, parameter.module)}: ${parameter.parameter.replaceAll('_', ' ')}`;
  const range = declared === undefined || declared.wraps ? 'any angle' : `${formatRaw(declared.minimum, declared)} to ${formatRaw(declared.maximum, declared)} ${declared.unit}`.trim();
  const toSet = () => (declared === undefined ? '' : [parameter.lower, parameter.upper].join(' '));
  return (
    <fieldset class="copies" data-parameter={parameter.parameter}>
      <legend>{title}</legend>
      <p class="hint wide">
        {declared === undefined ? '' : `${splitHelp(declared.help).sentence} Possible: ${range}.`}
      </p>
      <div class="fields">
        <ChoiceField
          label="joints"
          value={parameter.joints === null ? 'all' : 'chosen'}
          texts={{ all: 'all joints', chosen: 'chosen joints' }}
          isDisabled={false}
          commit={(value) => change({ joints: value === 'all' ? null : [...(module?.joints ?? [])] })}
        />
        <ChoiceField
          label="they have"
          value={parameter.same ? 'same' : 'own'}
          texts={{ own: 'each its own value', same: 'one value for all' }}
          isDisabled={false}
          commit={(value) => change({ same: value === 'same' })}
        />
        <ChoiceField
          label="out of"
          value={parameter.set === null ? 'range' : 'set'}
          texts={{ range: 'a range', set: 'explicit values' }}
          isDisabled={false}
          commit={(value) => change({ set: value === 'set' ? toSet() : null })}
        />
        <button type="button" aria-label={`Remove ${title}`} title="The search leaves it as it is in the draft" onClick={remove}>
          ✕
        </button>
      </div>
      {parameter.joints !== null && <JointChoice draft={draft} parameter={parameter} change={(joints) => change({ joints })} />}
      <div class="fields">
        <ValueFields path={path} parameter={parameter} problem={problem} unit={declared?.unit ?? ''} change={change} />
      </div>
      <FieldAlert problem={problem} isAbout={(field) => field === path || [`joints`, `same`, `module`, `parameter`].some((name) => field === `${path}.${name}`)} />
    </fieldset>
  );
}

export function ParameterFields({ draft, algorithms, problem, parameters, change }: Part & { parameters: readonly ChosenParameter[]; change(parameters: ChosenParameter[]): void }) {
  const wanted = useSignal('');
  const choices = draft.behaviour.modules.flatMap(({ algorithm, joints }, module) =>
    joints.length === 0
      ? []
      : (algorithms.find(({ name }) => name === algorithm)?.parameters ?? []).map((parameter) => ({ key: `${module}/${parameter.name}`, module, parameter })),
  );
  const isThere = ({ module, parameter }: (typeof choices)[number]) => parameters.some((each) => each.module === module && each.parameter === parameter.name);
  const next = choices.find(({ key }) => key === wanted.value) ?? choices.find((choice) => !isThere(choice)) ?? choices[0];
  const add = () => {
    if (next === undefined) return;
    change([...parameters, newParameter(next.module, next.parameter)]);
    wanted.value = '';
  };
  return (
    <section aria-label="What may change">
      <h3>What may change</h3>
      {parameters.map((parameter, number) => (
        <ParameterRow
          key={number}
          draft={draft}
          algorithms={algorithms}
          problem={problem}
          number={number}
          parameter={parameter}
          change={(part) => change(parameters.map((each, i) => (i === number ? { ...each, ...part } : each)))}
          remove={() => change(parameters.filter((_, i) => i !== number))}
        />
      ))}
      <FieldAlert problem={problem} isAbout={(field) => field === 'parameters'} />
      {next !== undefined && (
        <div class="fields">
          <label class="number-field">
            <span>parameter</span>
            <select value={next.key} onChange={(event) => (wanted.value = event.currentTarget.value)}>
              {draft.behaviour.modules.map((_, module) => (
                <optgroup key={module} label={moduleTitle(draft, module)}>
                  {choices
                    .filter((choice) => choice.module === module)
                    .map((choice) => (
                      <option key={choice.key} value={choice.key}>
                        {choice.parameter.name.replaceAll('_', ' ')}
                        {isThere(choice) ? ' (again, for other joints)' : ''}
                      </option>
                    ))}
                </optgroup>
              ))}
            </select>
          </label>
          <button type="button" onClick={add}>
            Add
          </button>
        </div>
      )}
    </section>
  );
}
