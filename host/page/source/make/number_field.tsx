// A number that is sent when it is complete: with Enter, or when the field is left.
import { useSignal } from '@preact/signals';
import { formatNumber, parseNumber } from '../state/parameter_values.js';

interface Field {
  label: string;
  value: number;
  unit?: string;
  title?: string;
  decimals?: number;
  isDisabled?: boolean;
  // Returns the reason if the value was refused, else null.
  commit(value: number): Promise<string | null> | string | null;
}

export function NumberField({ label, value, unit, title, decimals = 4, isDisabled, commit }: Field) {
  const typed = useSignal<string | null>(null);
  const problem = useSignal<string | null>(null);
  const shown = formatNumber(value, decimals);
  const send = async () => {
    const text = typed.peek();
    if (text === null) return;
    const number = parseNumber(text);
    if (typeof number === 'string') {
      problem.value = number;
      return;
    }
    problem.value = number === Number(shown) ? null : await commit(number);
    // A value that was refused stays, so that it can be corrected.
    if (problem.peek() === null && typed.peek() === text) typed.value = null;
  };
  return (
    <label class="number-field" title={title}>
      <span>{label}</span>
      <input
        type="text"
        inputMode="decimal"
        size={8}
        aria-label={unit === undefined || unit === '' ? label : `${label} in ${unit}`}
        value={typed.value ?? shown}
        disabled={isDisabled === true}
        aria-invalid={problem.value !== null}
        onInput={(event) => (typed.value = event.currentTarget.value)}
        onBlur={() => void send()}
        onKeyDown={(event) => {
          if (event.key === 'Enter') void send();
        }}
      />
      {unit !== undefined && unit !== '' && <span class="unit">{unit}</span>}
      {problem.value !== null && (
        <span class="problem" role="alert">
          {problem.value}
        </span>
      )}
    </label>
  );
}
