// How the search chooses its candidates: the method, and its settings, which are folded away.
import type { Experiment, ExperimentAxis, Measure, MethodSetting, SearchMethod } from '../../wire/messages.js';
import { ChoiceField } from '../fields/choice_field.js';
import type { FieldProblem } from '../fields/field_problem.js';
import { FormField } from '../fields/form_field.js';
import { usualAxes, withMethod } from './experiment_defaults.js';
import { FieldAlert } from './field_alert.js';
import { MeasureChoice } from './rating_fields.js';
import { sentence } from './search_text.js';

const keyOf = ({ tag, algorithm }: Pick<SearchMethod, 'tag' | 'algorithm'>) => `${tag}/${algorithm ?? ''}`;

const objectiveTexts: Record<SearchMethod['objectives'], string> = {
  one: 'For one objective.',
  several: 'For two objectives or more.',
  any: 'For one objective or more.',
};

function hintOf({ help, kind, lowest, highest, default: usual }: MethodSetting): string {
  const range = kind === 'choice' || lowest === null || highest === null ? '' : ` ${lowest} to ${highest}.`;
  return `${sentence(help)}${range}${usual === '' && kind !== 'choice' ? ' Empty: left to the method.' : ''}`;
}

function SettingField({ setting, value, problem, change }: { setting: MethodSetting; value: string; problem: FieldProblem | null; change(text: string): void }) {
  if (setting.kind === 'choice') {
    const usual = setting.default === '' ? 'left to the method' : `usual: ${setting.default}`;
    return (
      <ChoiceField
        label={setting.name}
        value={value === '' ? ' ' : value}
        texts={Object.fromEntries([[' ', usual], ...(setting.choices ?? []).map((choice) => [choice, choice])])}
        isDisabled={false}
        commit={(choice) => change(choice.trim())}
      />
    );
  }
  return (
    <FormField
      name={`settings.${setting.name}`}
      label={setting.name}
      value={value}
      size={7}
      isNumeric
      placeholder={setting.default}
      problem={problem}
      change={change}
    />
  );
}

// The axes of a map of gaits.
function AxisFields({ axes, measures, most, problem, change }: {
  axes: readonly ExperimentAxis[];
  measures: readonly Measure[];
  most: number;
  problem: FieldProblem | null;
  change(axes: ExperimentAxis[]): void;
}) {
  const set = (place: number, part: Partial<ExperimentAxis>) => change(axes.map((axis, i) => (i === place ? { ...axis, ...part } : axis)));
  return (
    <>
      <p class="hint">Each cell of the map keeps the best gait whose measures are in it. Cells stay empty if there are centroids in the settings.</p>
      {axes.map((axis, place) => (
        <div class="fields" key={place} role="group" aria-label={`Axis ${place + 1}`}>
          <MeasureChoice label="axis" measures={measures} value={axis.measure} change={(measure) => set(place, { measure })} />
          {(['lowest', 'highest', 'cells'] as const).map((name) => (
            <FormField key={name} name={`axes.${place}.${name}`} label={name} value={axis[name]} size={6} isNumeric problem={problem} change={(text) => set(place, { [name]: text })} />
          ))}
          {axes.length > 1 && (
            <button type="button" onClick={() => change(axes.filter((_, i) => i !== place))}>
              Remove the axis
            </button>
          )}
        </div>
      ))}
      {axes.length < most && (
        <div class="fields">
          <button type="button" onClick={() => change([...axes, { ...(usualAxes[axes.length % usualAxes.length] as ExperimentAxis) }])}>
            Add an axis
          </button>
        </div>
      )}
    </>
  );
}

export function MethodFields({ experiment, measures, mostAxes, methods, method, problem, change }: {
  experiment: Experiment;
  measures: readonly Measure[];
  mostAxes: number;
  methods: readonly SearchMethod[];
  method: SearchMethod | undefined;
  problem: FieldProblem | null;
  change(part: Partial<Experiment>): void;
}) {
  const { settings } = experiment;
  const choose = (key: string) => {
    const next = methods.find((each) => keyOf(each) === key);
    if (next !== undefined) change(withMethod(experiment, next));
  };
  const typed = Object.values(settings).filter((text) => text !== '').length;
  const isOfSetting = problem?.field.startsWith('settings.') === true;
  return (
    <section aria-label="Method">
      <h3>Method</h3>
      <div class="fields">
        <label class="number-field">
          <span>method</span>
          <select name="method" value={method === undefined ? '' : keyOf(method)} onChange={(event) => choose(event.currentTarget.value)}>
            {method === undefined && <option value="">{experiment.method}</option>}
            {methods.map((each) => (
              <option key={keyOf(each)} value={keyOf(each)}>
                {each.title}
              </option>
            ))}
          </select>
        </label>
      </div>
      {method !== undefined && (
        <p class="hint">
          {sentence(method.help)} {objectiveTexts[method.objectives]}
        </p>
      )}
      <FieldAlert problem={problem} isAbout={(field) => field === 'method' || (field.startsWith('settings.') && method?.settings.every(({ name, kind }) => field !== `settings.${name}` || kind === 'choice') === true)} />
      {method?.has_map === true && <AxisFields axes={experiment.axes} measures={measures} most={mostAxes} problem={problem} change={(axes) => change({ axes })} />}
      {method !== undefined && method.settings.length > 0 && (
        <details open={isOfSetting}>
          <summary>
            Settings of the method{typed > 0 ? ` (${typed} not as usual)` : ''}
          </summary>
          {method.settings.map((setting) => (
            <div class="fields" key={setting.name}>
              <SettingField setting={setting} value={settings[setting.name] ?? ''} problem={problem} change={(text) => change({ settings: { ...settings, [setting.name]: text } })} />
              <span class="hint">{hintOf(setting)}</span>
            </div>
          ))}
        </details>
      )}
    </section>
  );
}
