// The form of a new sweep. The program checks it while it is edited.
import { algorithmTitle } from '../../state/robot_text.js';
import type { DraftDocument } from '../../wire/messages.js';
import { ChoiceField } from '../fields/choice_field.js';
import type { FieldProblem } from '../fields/field_problem.js';
import { FormField } from '../fields/form_field.js';
import { parameterOf } from '../search/experiment_defaults.js';
import { FieldAlert } from '../search/field_alert.js';
import type { EngineChoice } from '../search/new_search.js';
import { countText, durationText } from '../search/search_text.js';
import { mostQuantities, worldQuantities, type NewSweep, type Quantity, type WorldQuantity } from './new_sweep.js';
import type { SweepApp } from './sweep_app.js';

const worldTexts: Record<WorldQuantity, string> = { friction: 'friction of the ground', heading: 'heading at the start', x: 'x of the start', y: 'y of the start' };

// What can be swept, by the value of its option: "0/amplitude", "friction".
function quantityTexts(draft: DraftDocument): Record<string, string> {
  const texts: Record<string, string> = {};
  for (const [number, module] of draft.behaviour.modules.entries()) {
    if (module.joints.length === 0) continue;
    for (const parameter of Object.keys(module.values)) texts[`${number}/${parameter}`] = `${number + 1}. ${algorithmTitle(module.algorithm)}: ${parameter.replaceAll('_', ' ')}`;
  }
  return { ...texts, ...worldTexts };
}

function QuantityFields({ app, draft, place, quantity, problem }: { app: SweepApp; draft: DraftDocument; place: number; quantity: Quantity; problem: FieldProblem | null }) {
  const { form } = app;
  const path = `over.${place}`;
  const isParameter = quantity.kind === 'parameter';
  const module = draft.behaviour.modules[quantity.module];
  const unit = quantity.kind === 'parameter' ? (parameterOf(app.host.page.state.algorithms.value, module, quantity.parameter)?.unit ?? '') : worldQuantities[quantity.kind].unit;
  const joints = Object.fromEntries([['', 'all joints'], ...(module?.joints ?? []).map((joint) => [draft.robot.joints[joint]!.name, draft.robot.joints[joint]!.name])]) as Record<string, string>;
  const choose = (value: string) => {
    const [number, parameter] = value.split('/');
    if (parameter !== undefined) form.change(place, form.ofParameter(Number(number), parameter));
    else form.change(place, { kind: value as WorldQuantity, joint: null, ...worldQuantities[value as WorldQuantity] });
  };
  return (
    <div class="quantity" role="group" aria-label={`Quantity ${place + 1}`}>
      <div class="fields">
        <ChoiceField label="quantity" value={isParameter ? `${quantity.module}/${quantity.parameter}` : quantity.kind} texts={quantityTexts(draft)} isDisabled={false} commit={choose} />
        {isParameter && <ChoiceField label="of" value={quantity.joint ?? ''} texts={joints} isDisabled={false} commit={(joint) => form.change(place, { joint: joint === '' ? null : joint })} />}
        {place > 0 && (
          <button type="button" aria-label={`Remove quantity ${place + 1}`} onClick={() => (form.quantities.value = form.quantities.peek().filter((_, i) => i !== place))}>
            ✕
          </button>
        )}
      </div>
      <div class="fields">
        {(['first', 'last', 'step'] as const).map((name) => (
          <FormField
            key={name}
            name={`${path}.${name}`}
            label={name}
            unit={unit === '' ? '' : unit}
            value={quantity[name]}
            size={7}
            isNumeric
            problem={null}
            title={name === 'last' ? 'Included if a step ends there' : ''}
            change={(text) => form.change(place, { [name]: text })}
          />
        ))}
      </div>
      <FieldAlert problem={problem} isAbout={(field) => field === path} />
    </div>
  );
}

function summaryText(form: NewSweep): string {
  const check = form.check.value;
  if (check === null) return form.checks.isWaiting.value ? 'Checking …' : '';
  const duration = form.duration.value;
  const time = form.isMeasuring.value ? 'measuring how long one takes …' : duration === null ? '' : `about ${durationText(duration)}`;
  const seeds = check.has_equal_seeds ? 'all seeds give the same run: the gait and the sensors have no noise' : '';
  return [`${countText(check.runs)} ${check.runs === 1 ? 'run' : 'runs'}`, time, seeds].filter(Boolean).join('; ');
}

const shownAtFields = /^(over\.\d+|seeds|measure|engine|name)$/;

export function SweepFormView({ app }: { app: SweepApp }) {
  const { form } = app;
  const draft = app.host.draft.value;
  const { searchMethods, sweeps } = app.host.page.state;
  const measures = searchMethods.value?.measures ?? [];
  if (draft === null || measures.length === 0) return <p class="wait">Waiting for the program …</p>;
  const problem = form.problem.value;
  const obstacle = app.host.obstacle();
  const quantities = form.quantities.value;
  const reduced = form.answer.value?.reduced ?? null;
  const own = `${form.answer.value === null ? 'that of Run' : form.answer.value.engine === 'ode' ? 'ODE' : form.answer.value.engine}, as Run has it`;
  const engineTexts: Partial<Record<EngineChoice, string>> = reduced === null ? { best: 'reduced: fastest (recommended)', own } : { best: own };
  const processors = sweeps.value?.processors ?? 1;
  return (
    <form
      class="panel make-panel search-form"
      aria-label="New sweep"
      data-testid="sweep-form"
      onSubmit={(event) => {
        event.preventDefault();
        void app.start();
      }}
    >
      <h2>New sweep</h2>
      {quantities.map((quantity, place) => (
        <QuantityFields key={place} app={app} draft={draft} place={place} quantity={quantity} problem={problem} />
      ))}
      <div class="fields">
        <button
          type="button"
          disabled={quantities.length >= mostQuantities}
          title={quantities.length >= mostQuantities ? 'A map has two quantities.' : 'Two quantities make a map'}
          onClick={() => (form.quantities.value = [...form.quantities.peek(), { kind: 'friction', module: 0, parameter: '', joint: null, ...worldQuantities.friction }])}
        >
          Add a second quantity
        </button>
        <FormField name="seeds" label="seeds" value={form.seeds.value} size={4} isNumeric problem={problem} title="Each combination is simulated with so many seeds, from 1 on; the picture has their means." change={(seeds) => (form.seeds.value = seeds)} />
      </div>
      <div class="fields">
        <ChoiceField
          label="measure"
          value={form.measure.value}
          texts={Object.fromEntries(measures.map(({ name }) => [name, name.replaceAll('_', ' ')]))}
          title="All measures are kept: another one can be shown later."
          isDisabled={false}
          commit={(measure) => (form.measure.value = measure)}
        />
        <ChoiceField
          label="engine"
          value={reduced === null ? form.engine.value : 'best'}
          texts={engineTexts as Record<EngineChoice, string>}
          title={reduced === null ? '' : `The reduced engine cannot: ${reduced}`}
          isDisabled={false}
          commit={(engine) => (form.engine.value = engine)}
        />
        <ChoiceField
          label="workers"
          value={String(form.workers.value ?? 0)}
          texts={Object.fromEntries([['0', `all processors (${processors})`], ...Array.from({ length: processors }, (_, i) => [String(i + 1), String(i + 1)])]) as Record<string, string>}
          title="Programs that simulate side by side. The result does not depend on them."
          isDisabled={false}
          commit={(workers) => (form.workers.value = workers === '0' ? null : Number(workers))}
        />
      </div>
      <FieldAlert problem={problem} isAbout={(field) => field === 'measure' || field === 'engine' || !shownAtFields.test(field)} />
      <p role="status" class={form.checks.isWaiting.value ? 'old' : ''} data-testid="sweep-summary">
        {summaryText(form)}
      </p>
      <div class="fields">
        <FormField name="name" label="name" value={form.name.value} size={22} problem={problem} title="Of its folder, in the folder sweeps" change={(name) => (form.typedName.value = name)} />
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
