// What makes a result trustworthy, and what saves time: trials in other worlds, fresh runs of the best, giving up early.
import type { ComponentChildren } from 'preact';
import type { Experiment, Trials } from '../../wire/messages.js';
import { ChoiceField } from '../fields/choice_field.js';
import type { FieldProblem } from '../fields/field_problem.js';
import { FormField } from '../fields/form_field.js';

const newTrials: Trials = { count: '5', aggregate: 'worst', random_numbers: 'common', friction: '0.1', mass: '', servo_gain: '', latency: '', contact_noise: '' };

const variations = [
  { name: 'friction', label: 'friction ±', title: 'All coefficients of friction are multiplied by one factor from 1 − x to 1 + x. 0 to 0.9.' },
  { name: 'mass', label: 'mass ±', title: 'Mass of each link is multiplied by a factor of its own. 0 to 0.9.' },
  { name: 'servo_gain', label: 'servo gain ±', title: 'The gains of all servos are multiplied by one factor. 0 to 0.9.' },
  { name: 'latency', label: 'latency up to', unit: 'ms', title: 'Additional latency of the servos. 0 to 100.' },
  { name: 'contact_noise', label: 'contact noise', title: 'How often a touch sensor is wrong. 0 to 1.' },
] as const;

// A part of the experiment that is there, or not. Space is STOP, so Enter switches it.
function Switch({ title, isOn, toggle, children }: { title: string; isOn: boolean; toggle(): void; children: ComponentChildren }) {
  return (
    <div class="switched">
      <label class="switch">
        <input
          type="checkbox"
          checked={isOn}
          onChange={toggle}
          onKeyDown={(event) => {
            if (event.key !== 'Enter') return;
            event.preventDefault();
            toggle();
          }}
        />
        {title}
      </label>
      {isOn && <div class="fields">{children}</div>}
    </div>
  );
}

interface Fields {
  experiment: Experiment;
  problem: FieldProblem | null;
  change(part: Partial<Experiment>): void;
}

export function TrialFields({ experiment, problem, change }: Fields) {
  const { trials, confirmation, racing, reuse } = experiment;
  const setTrials = (part: Partial<Trials>) => change({ trials: { ...(trials ?? newTrials), ...part } });
  const isOpen = trials !== null || confirmation !== null || racing !== null || !reuse || (problem !== null && /^(trials|confirmation|racing|reuse)\b/.test(problem.field));
  const number = (name: string, label: string, value: string, title: string, set: (text: string) => void) => (
    <FormField name={name} label={label} value={value} size={5} isNumeric problem={problem} title={title} change={set} />
  );
  return (
    <details open={isOpen}>
      <summary>Trials in other worlds, confirmation, giving up early</summary>
      <Switch title="rate each candidate by several trials" isOn={trials !== null} toggle={() => change({ trials: trials === null ? newTrials : null })}>
        {trials !== null && (
          <>
            {number('trials.count', 'trials', trials.count, 'Runs of each candidate. 1 to 1000.', (count) => setTrials({ count }))}
            <ChoiceField label="score" value={trials.aggregate || 'mean'} texts={{ mean: 'their mean', worst: 'the worst of them' }} isDisabled={false} commit={(aggregate) => setTrials({ aggregate })} />
            <ChoiceField
              label="worlds"
              value={trials.random_numbers || 'common'}
              texts={{ common: 'the same for all candidates', fresh: 'new for each evaluation' }}
              isDisabled={false}
              commit={(random_numbers) => setTrials({ random_numbers })}
            />
            {variations.map(({ name, label, title, ...more }) => (
              <FormField
                key={name}
                name={`trials.${name}`}
                label={label}
                unit={'unit' in more ? more.unit : ''}
                value={trials[name]}
                size={5}
                isNumeric
                placeholder="0"
                problem={problem}
                title={title}
                change={(text) => setTrials({ [name]: text })}
              />
            ))}
          </>
        )}
      </Switch>
      <Switch
        title="other numbers for the confirmation of the best"
        isOn={confirmation !== null}
        toggle={() => change({ confirmation: confirmation === null ? { candidates: '5', runs: '10' } : null })}
      >
        {confirmation !== null && (
          <>
            {number('confirmation.candidates', 'candidates', confirmation.candidates, 'The best that are rated again. 1 to 1000.', (candidates) => change({ confirmation: { ...confirmation, candidates } }))}
            {number('confirmation.runs', 'fresh runs', confirmation.runs, 'Of each. 0: none.', (runs) => change({ confirmation: { ...confirmation, runs } }))}
          </>
        )}
      </Switch>
      <Switch title="give poor candidates up early" isOn={racing !== null} toggle={() => change({ racing: racing === null ? { after: '0.3', keep: '0.5' } : null })}>
        {racing !== null && (
          <>
            {number('racing.after', 'after this share of a run', racing.after, '0 to 0.99', (after) => change({ racing: { ...racing, after } }))}
            {number('racing.keep', 'below this share of the score it needs', racing.keep, '0 to 1', (keep) => change({ racing: { ...racing, keep } }))}
          </>
        )}
      </Switch>
      <Switch title="use known results of equal candidates" isOn={reuse} toggle={() => change({ reuse: !reuse })}>
        {null}
      </Switch>
    </details>
  );
}
