// How the search chooses its candidates: the method, and its settings, which are folded away.
import type { Experiment, MethodSetting, SearchMethod } from '../../wire/messages.js';
import { ChoiceField } from '../fields/choice_field.js';
import type { FieldProblem } from '../fields/field_problem.js';
import { FormField } from '../fields/form_field.js';
import { settingsFor } from './experiment_defaults.js';
import { FieldAlert } from './field_alert.js';
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

export function MethodFields({ experiment, methods, method, problem, change }: {
  experiment: Experiment;
  methods: readonly SearchMethod[];
  method: SearchMethod | undefined;
  problem: FieldProblem | null;
  change(part: Partial<Experiment>): void;
}) {
  const { settings } = experiment;
  const choose = (key: string) => {
    const next = methods.find((each) => keyOf(each) === key);
    if (next !== undefined) change({ method: next.tag, algorithm: next.algorithm ?? '', settings: settingsFor(next, settings) });
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
