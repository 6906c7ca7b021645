// A text of a form that is judged as a whole: what is wrong with it is said here.
import type { FieldProblem } from './field_problem.js';

interface Field {
  name: string; // as in refusals
  label: string;
  value: string;
  size: number;
  problem: FieldProblem | null;
  unit?: string;
  title?: string;
  placeholder?: string;
  isNumeric?: boolean; // the keyboard of a phone
  change(text: string): void;
}

export function FormField({ name, label, value, size, problem, unit = '', title, placeholder, isNumeric = false, change }: Field) {
  const isWrong = problem?.field === name;
  return (
    <label class="number-field" title={title}>
      <span>{label}</span>
      <input
        type="text"
        name={name}
        size={size}
        value={value}
        inputMode={isNumeric ? 'decimal' : 'text'}
        placeholder={placeholder}
        autocomplete="off"
        spellcheck={false}
        aria-label={unit === '' ? label : `${label} in ${unit}`}
        aria-invalid={isWrong}
        onInput={(event) => change(event.currentTarget.value)}
      />
      {unit !== '' && <span class="unit">{unit}</span>}
      {isWrong && (
        <span class="problem" role="alert">
          {problem.text}
        </span>
      )}
    </label>
  );
}
