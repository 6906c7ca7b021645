// An actuation module: its algorithm, and the parameters of that, for all its joints or for each.
import { useSignal } from '@preact/signals';
import { ParameterSlider } from '../panels/parameter_slider.js';
import { formatNumber, formatRaw, parseValue, splitHelp } from '../state/parameter_values.js';
import type { AlgorithmDocument, AlgorithmParameter, BehaviourModule, DraftRobot } from '../wire/messages.js';
import { fromTail } from '../state/robot_text.js';
import { ChoiceField } from './fields/choice_field.js';
import type { MakeApp } from './make_app.js';
import { TextField } from './fields/text_field.js';

interface Row {
  app: MakeApp;
  robot: DraftRobot;
  module: BehaviourModule;
  number: number;
  parameter: AlgorithmParameter;
}

// The text of a value as the program takes it.
function plain(value: number): string {
  return formatNumber(value, 9);
}

function ParameterFields({ app, robot, module, number, parameter }: Row) {
  const isOpen = useSignal(false);
  const gesture = useSignal(0);
  const values = module.values[parameter.name] ?? [];
  const first = values[0] ?? parameter.default;
  const isUniform = values.every((value) => value === first);
  const mean = values.length === 0 ? first : values.reduce((sum, raw) => sum + raw, 0) / values.length;
  const isDisabled = app.obstacle() !== null || module.joints.length === 0;
  const title = parameter.name.replaceAll('_', ' ');
  const id = `module-${number}-${parameter.name}`;
  const words = (joints: readonly number[], value: number) => ({ module: number, parameter: parameter.name, joints, value: plain(value) });
  const set = (joints: readonly number[], text: string) => {
    if (text === '') return null;
    const value = parseValue(text, parameter);
    return typeof value === 'string' ? value : app.changes.change('behaviour.set', words(joints, value));
  };
  const range = parameter.wraps
    ? 'Any angle'
    : `${formatRaw(parameter.minimum, parameter)} to ${formatRaw(parameter.maximum, parameter)} ${parameter.unit}`.trim();
  return (
    <div class="module-parameter" data-parameter={parameter.name}>
      <div class="fields">
        <TextField
          label={parameter.unit === '' ? title : `${title} in ${parameter.unit}`}
          isNumeric
          size={8}
          value={isUniform ? formatRaw(first, parameter) : ''}
          placeholder={isUniform ? '' : 'several'}
          isDisabled={isDisabled}
          title={`${range}; usually ${formatRaw(parameter.default, parameter)}`}
          commit={(text) => set(module.joints, text)}
        />
        <ParameterSlider
          parameter={parameter}
          value={mean * parameter.scale}
          label={`${title}, all joints`}
          describedBy={id}
          isDisabled={isDisabled}
          begin={() => (gesture.value = app.page.newGesture())}
          set={(value) => app.changes.follow('behaviour.set', words(module.joints, value), gesture.value)}
          reset={() => void app.changes.tell('behaviour.set', words(module.joints, parameter.default * parameter.scale))}
        />
        <button type="button" aria-expanded={isOpen.value} disabled={module.joints.length < 2} title="A value for each joint" onClick={() => (isOpen.value = !isOpen.value)}>
          {isUniform ? 'each joint' : 'they differ'}
        </button>
      </div>
      <p class="hint" id={id}>
        {splitHelp(parameter.help).sentence} {range}.
      </p>
      {isOpen.value && (
        <div class="fields">
          {fromTail(robot.joints.length)
            .filter((joint) => module.joints.includes(joint))
            .map((joint) => (
              <TextField
                key={joint}
                label={robot.joints[joint]!.name}
                isNumeric
                size={6}
                value={formatRaw(values[module.joints.indexOf(joint)] ?? parameter.default, parameter)}
                isDisabled={isDisabled}
                commit={(text) => set([joint], text)}
              />
            ))}
        </div>
      )}
    </div>
  );
}

export function ModuleForm({ app, robot, module, number, algorithms, isOnly }: {
  app: MakeApp;
  robot: DraftRobot;
  module: BehaviourModule;
  number: number;
  algorithms: readonly AlgorithmDocument[];
  isOnly: boolean;
}) {
  const obstacle = app.obstacle();
  const algorithm = algorithms.find(({ name }) => name === module.algorithm);
  const most = app.page.state.parts.value?.most_modules ?? 4;
  const isFull = (app.draft.value?.behaviour.modules.length ?? 0) >= most;
  const copy = async () => {
    if (await app.changes.tell('behaviour.duplicate', { module: number, joints: [...module.joints] })) app.chosenModule.value = number + 1;
  };
  return (
    <section class="panel make-panel" aria-label={`Module ${number + 1}`}>
      <h2>
        Module {number + 1}
      </h2>
      <div class="fields">
        <ChoiceField
          label="algorithm"
          value={module.algorithm}
          texts={Object.fromEntries(algorithms.map(({ name }) => [name, name]))}
          isDisabled={obstacle !== null}
          title="It keeps the values of parameters that both have."
          commit={(name) => void app.changes.tell('behaviour.algorithm', { module: number, algorithm: name })}
        />
        <button type="button" disabled={obstacle !== null || isFull} title={obstacle ?? (isFull ? `A robot has at most ${most} actuation modules.` : 'A second module with the same values')} onClick={() => void copy()}>
          Copy
        </button>
        <button type="button" disabled={obstacle !== null || isOnly} title={obstacle ?? (isOnly ? 'A robot has at least one.' : 'Undo brings it back')} onClick={() => void app.changes.tell('behaviour.remove', { module: number })}>
          Delete
        </button>
      </div>
      {algorithm !== undefined && <p class="hint">{algorithm.help}</p>}
      {algorithm?.parameters.map((parameter) => (
        <ParameterFields key={parameter.name} app={app} robot={robot} module={module} number={number} parameter={parameter} />
      ))}
    </section>
  );
}
