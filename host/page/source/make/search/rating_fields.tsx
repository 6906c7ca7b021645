// What is rated: a measure; for experts several objectives, and weighted sums of measures.
import { useSignal } from '@preact/signals';
import type { Experiment, Measure, Objective, ObjectiveTerm } from '../../wire/messages.js';
import { ChoiceField } from '../fields/choice_field.js';
import type { FieldProblem } from '../fields/field_problem.js';
import { FormField } from '../fields/form_field.js';
import { newObjective } from './experiment_defaults.js';
import { FieldAlert } from './field_alert.js';
import { sentence } from './search_text.js';

export function MeasureChoice({ label = 'measure', measures, value, change }: {
  label?: string;
  measures: readonly Measure[];
  value: string;
  change(measure: string): void;
}) {
  return (
    <label class="number-field">
      <span>{label}</span>
      <select value={value} onChange={(event) => change(event.currentTarget.value)}>
        {measures.map(({ name, unit }) => (
          <option key={name} value={name}>
            {name.replaceAll('_', ' ')}
            {unit === '' ? '' : ` (${unit})`}
          </option>
        ))}
      </select>
    </label>
  );
}

function ObjectiveRow({ path, objective, measures, problem, isExpert, change, remove }: {
  path: string;
  objective: Objective;
  measures: readonly Measure[];
  problem: FieldProblem | null;
  isExpert: boolean;
  change(part: Partial<Objective>): void;
  remove: (() => void) | null;
}) {
  const first = measures.find(({ name }) => name === objective.terms[0]?.measure);
  const isSum = objective.terms.length > 1 || objective.terms.some(({ weight }) => weight.trim() !== '');
  const usual = first === undefined || isSum ? 'as the measure has it' : `usual: ${first.higher_is_better ? 'maximise' : 'minimise'}`;
  const setTerm = (place: number, part: Partial<ObjectiveTerm>) => change({ terms: objective.terms.map((term, i) => (i === place ? { ...term, ...part } : term)) });
  return (
    <div class="objective" role="group" aria-label={`Objective ${Number(path.split('.')[1]) + 1}`}>
      {objective.terms.map((term, place) => (
        <div class="fields" key={place}>
          {place > 0 && <span class="unit">+</span>}
          <MeasureChoice measures={measures} value={term.measure} change={(measure) => setTerm(place, { measure })} />
          {isExpert && (
            <FormField name={`${path}.terms.${place}.weight`} label="weight" value={term.weight} size={6} isNumeric placeholder="1" problem={problem} change={(weight) => setTerm(place, { weight })} />
          )}
          {place > 0 && (
            <button type="button" aria-label={`Remove ${term.measure} from the sum`} onClick={() => change({ terms: objective.terms.filter((_, i) => i !== place) })}>
              ✕
            </button>
          )}
        </div>
      ))}
      <div class="fields">
        <ChoiceField
          label="goal"
          value={objective.goal === '' ? 'usual' : objective.goal}
          texts={{ usual, maximise: 'maximise', minimise: 'minimise' }}
          isDisabled={false}
          commit={(value) => change({ goal: value === 'usual' ? '' : value })}
        />
        {isExpert && (
          <>
            <FormField name={`${path}.name`} label="name" value={objective.name} size={12} placeholder={objective.terms[0]?.measure ?? ''} problem={problem} change={(name) => change({ name })} />
            <FormField
              name={`${path}.failed`}
              label="score of a failed run"
              value={objective.failed}
              size={7}
              isNumeric
              problem={problem}
              title="It must be worse than that of every other run. Needed for a sum, and to maximise what may be negative."
              change={(failed) => change({ failed })}
            />
            <button type="button" title="A weighted sum of measures" onClick={() => change({ terms: [...objective.terms, { measure: 'distance', weight: '1' }] })}>
              Add a measure
            </button>
          </>
        )}
        {remove !== null && (
          <button type="button" onClick={remove}>
            Remove the objective
          </button>
        )}
      </div>
      <p class="hint">{objective.terms.map(({ measure }) => sentence(measures.find(({ name }) => name === measure)?.help ?? '')).join(' ')}</p>
      <FieldAlert problem={problem} isAbout={(field) => field === path || new RegExp(`^${path}\\.(goal|terms(\\.\\d+(\\.measure)?)?)$`).test(field) || (!isExpert && field === `${path}.failed`)} />
    </div>
  );
}

export function RatingFields({ experiment, measures, most, problem, change }: {
  experiment: Experiment;
  measures: readonly Measure[];
  most: number; // objectives
  problem: FieldProblem | null;
  change(part: Partial<Experiment>): void;
}) {
  const wantsMore = useSignal(false);
  const { objectives } = experiment;
  const isSimple = objectives.length === 1 && objectives[0]!.terms.length === 1 && objectives[0]!.terms[0]!.weight === '' && experiment.heading === '';
  const isHidden = problem !== null && /^(heading|objectives(\.\d+\.(name|failed|terms\.\d+\.weight))?)$/.test(problem.field);
  const isExpert = wantsMore.value || !isSimple || isHidden;
  const set = (place: number, part: Partial<Objective>) => change({ objectives: objectives.map((each, i) => (i === place ? { ...each, ...part } : each)) });
  return (
    <section aria-label="What is rated">
      <h3>What is rated</h3>
      {objectives.map((objective, place) => (
        <ObjectiveRow
          key={place}
          path={`objectives.${place}`}
          objective={objective}
          measures={measures}
          problem={problem}
          isExpert={isExpert}
          change={(part) => set(place, part)}
          remove={objectives.length < 2 ? null : () => change({ objectives: objectives.filter((_, i) => i !== place) })}
        />
      ))}
      <div class="fields">
        <button type="button" aria-expanded={isExpert} disabled={!isSimple} onClick={() => (wantsMore.value = !wantsMore.value)}>
          Sums, several objectives, heading
        </button>
        {isExpert && (
          <>
            <button type="button" disabled={objectives.length >= most} onClick={() => change({ objectives: [...objectives, newObjective('mechanical_energy')] })}>
              Add an objective
            </button>
            <FormField
              name="heading"
              label="heading"
              unit="°"
              value={experiment.heading}
              size={5}
              isNumeric
              placeholder="0"
              problem={problem}
              title="Direction of the measure speed: 0 is where the head points at the start, 90 its left."
              change={(heading) => change({ heading })}
            />
          </>
        )}
      </div>
      <FieldAlert problem={problem} isAbout={(field) => field === 'objectives'} />
    </section>
  );
}
