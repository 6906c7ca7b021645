// Distortion: overwrites an internal value of an algorithm once, to see how the gait recovers.
import { useSignal } from '@preact/signals';
import type { Stores } from '../view/robot_view.js';
import { parseNumber, setWord } from '../state/parameter_values.js';
import type { InternalValue } from '../wire/messages.js';

export function DistortionForm({ app, values }: { app: Stores<'newGesture' | 'sets' | 'state'>; values: readonly InternalValue[] }) {
  const chosen = useSignal(0);
  const joint = useSignal('');
  const text = useSignal('0');
  const problem = useSignal<string | null>(null);
  const value = values[Math.min(chosen.value, values.length - 1)] as InternalValue;
  const robot = app.state.robot.value;
  const isHolder = app.state.isHolder.value;
  const apply = () => {
    const parsed = parseNumber(text.value);
    problem.value = typeof parsed === 'string' ? parsed : null;
    if (typeof parsed === 'number') {
      app.sets.set([setWord(value, joint.value === '' ? null : joint.value, parsed)], app.newGesture());
    }
  };
  return (
    <details class="distortion">
      <summary>Distort an internal value</summary>
      <p class="hint">
        Overwrites the value once; the algorithm goes on from there. {value.name.replace(/_/g, ' ')}: {value.help}.
      </p>
      <div class="distortion-fields">
        <select
          aria-label="Internal value"
          value={String(chosen.value)}
          onChange={(event) => (chosen.value = Number(event.currentTarget.value))}
        >
          {values.map((candidate, i) => (
            <option key={`${candidate.slot}.${candidate.name}`} value={String(i)}>
              {candidate.slot}. {candidate.name.replace(/_/g, ' ')}
            </option>
          ))}
        </select>
        <select aria-label="Joint" value={joint.value} onChange={(event) => (joint.value = event.currentTarget.value)}>
          <option value="">all joints</option>
          {value.joints.map((index) => (
            <option key={index} value={robot?.joints[index]?.name ?? ''}>
              {robot?.joints[index]?.name}
            </option>
          ))}
        </select>
        <input
          type="text"
          inputMode="decimal"
          aria-label={`Value in ${value.unit || 'numbers'}`}
          value={text.value}
          onInput={(event) => (text.value = event.currentTarget.value)}
        />
        <span class="unit">{value.unit}</span>
        <button type="button" disabled={!isHolder} onClick={apply}>
          Apply now
        </button>
      </div>
      {problem.value !== null && (
        <p class="problem" role="alert">
          {problem.value}
        </p>
      )}
    </details>
  );
}
