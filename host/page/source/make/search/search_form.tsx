// The form of a new search. The program checks it while it is edited.
import { ChoiceField } from '../fields/choice_field.js';
import { FormField } from '../fields/form_field.js';
import { FieldAlert } from './field_alert.js';
import { MethodFields } from './method_fields.js';
import type { EngineChoice, NewSearch } from './new_search.js';
import { ParameterFields } from './parameter_fields.js';
import { RatingFields } from './rating_fields.js';
import type { SearchApp } from './search_app.js';
import { countText, durationText } from './search_text.js';
import { timePresets } from './time_presets.js';
import { TrialFields } from './trial_fields.js';

// Fields that show what is wrong with them themselves.
const shownAtFields = /^(parameters(\.\d+(\.\w+)?)?|objectives(\.\d+(\.(name|goal|failed|terms(\.\d+(\.\w+)?)?))?)?|heading|method|(settings|trials|confirmation|racing)\.\w+|evaluations|seed|name|preset)$/;

function summaryText(form: NewSearch): string {
  const check = form.check.value;
  if (check === null) return form.checks.isWaiting.value ? 'Checking …' : '';
  const evaluations = check.planned === null ? 'until the method ends' : `${countText(check.planned)} evaluations`;
  const duration = form.duration.value;
  const time = form.isMeasuring.value ? 'measuring how long they take …' : duration === null ? '' : `about ${durationText(duration)}`;
  return [`${countText(check.candidates)} possible candidates`, evaluations, time].filter(Boolean).join('; ');
}

function TimeFields({ app, form }: { app: SearchApp; form: NewSearch }) {
  const experiment = form.experiment.value;
  if (experiment === null) return null;
  const problem = form.problem.value;
  const obstacle = app.host.obstacle();
  const processors = app.host.page.state.searches.value?.processors ?? 1;
  const known = form.lastGood.value;
  const reason = known?.reduced ?? null;
  const own = `${known === null ? 'that of Run' : known.engine === 'ode' ? 'ODE' : known.engine}, as Run has it`;
  // Where the reduced engine has no such scenario there is no choice.
  const engineTexts: Partial<Record<EngineChoice, string>> = reason === null ? { best: 'reduced: fastest (recommended)', own } : { best: own };
  return (
    <section aria-label="Time">
      <h3>Time</h3>
      <div class="fields" role="group" aria-label="How long">
        {timePresets.map(({ name, title }) => (
          <button
            key={name}
            type="button"
            aria-pressed={form.preset.value === name}
            disabled={obstacle !== null}
            title={obstacle ?? 'Measures some evaluations, and plans as many as fit into this time'}
            onClick={() => form.choosePreset(name)}
          >
            {title}
          </button>
        ))}
        <FormField
          name="evaluations"
          label="evaluations"
          value={experiment.evaluations}
          size={9}
          isNumeric
          problem={problem}
          title="The search ends after so many. 0: it ends when the method ends."
          change={(text) => form.setEvaluations(text)}
        />
      </div>
      <FieldAlert problem={problem} isAbout={(field) => field === 'preset'} />
      <div class="fields">
        <ChoiceField
          label="engine"
          value={reason === null ? form.engine.value : 'best'}
          texts={engineTexts as Record<EngineChoice, string>}
          title={reason === null ? 'The reduced engine searches; ODE simulates the best candidates again, and has the last word.' : `The reduced engine cannot: ${reason}`}
          isDisabled={false}
          commit={(engine) => (form.engine.value = engine)}
        />
        <ChoiceField
          label="workers"
          value={String(form.workers.value ?? 0)}
          texts={Object.fromEntries([['0', `all processors (${processors})`], ...Array.from({ length: processors }, (_, i) => [String(i + 1), String(i + 1)])])}
          title="Programs that simulate side by side. The result does not depend on them."
          isDisabled={false}
          commit={(workers) => (form.workers.value = workers === '0' ? null : Number(workers))}
        />
        <FormField
          name="seed"
          label="seed"
          value={experiment.seed}
          size={7}
          isNumeric
          problem={problem}
          title="Of all random numbers: the same seed repeats the search."
          change={(seed) => form.change({ seed })}
        />
      </div>
    </section>
  );
}

export function SearchForm({ app }: { app: SearchApp }) {
  const { form } = app;
  const experiment = form.experiment.value;
  const draft = app.host.draft.value;
  const { algorithms, searchMethods } = app.host.page.state;
  const documents = searchMethods.value;
  if (experiment === null || draft === null || documents === null) return <p class="wait">Waiting for the program …</p>;
  const problem = form.problem.value;
  const obstacle = app.host.obstacle();
  const change = form.change.bind(form);
  const text = form.check.value?.text ?? null;
  return (
    <form
      class="panel make-panel search-form"
      aria-label="New search"
      data-testid="search-form"
      onSubmit={(event) => {
        event.preventDefault();
        void app.start();
      }}
    >
      <h2>New search</h2>
      <ParameterFields draft={draft} algorithms={algorithms.value} problem={problem} parameters={experiment.parameters} change={(parameters) => change({ parameters })} />
      <RatingFields experiment={experiment} measures={documents.measures} most={documents.most_objectives} problem={problem} change={change} />
      <MethodFields experiment={experiment} measures={documents.measures} mostAxes={documents.most_axes} methods={documents.methods} method={form.method.value} problem={problem} change={change} />
      <TimeFields app={app} form={form} />
      <TrialFields experiment={experiment} problem={problem} change={change} />
      {text !== null && (
        <details>
          <summary>The experiment file</summary>
          <pre class="experiment-text" tabIndex={0}>
            {text}
          </pre>
        </details>
      )}
      <p role="status" class={form.checks.isWaiting.value ? 'old' : ''} data-testid="search-summary">
        {summaryText(form)}
      </p>
      <FieldAlert problem={problem} isAbout={(field) => !shownAtFields.test(field)} />
      <div class="fields">
        <FormField name="name" label="name" value={form.name.value} size={22} problem={problem} title="Of its folder, in the folder searches" change={(name) => (form.typedName.value = name)} />
        <button type="submit" class="primary" disabled={obstacle !== null || form.isStarting.value} title={obstacle ?? 'Starts a program of its own, which goes on when this page is closed'}>
          {form.isStarting.value ? 'Starting …' : 'Start'}
        </button>
        <button type="button" title="The form as it is at first" onClick={() => form.beginAnew()}>
          Begin anew
        </button>
        <button type="button" onClick={() => (form.isOpen.value = false)}>
          Close
        </button>
        {obstacle !== null && <span class="hint">{obstacle}</span>}
      </div>
    </form>
  );
}
