// A text that is sent when it is complete: with Enter, or when the field is left.
import { useSignal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import { addFront } from '../../view/front.js';

interface Field {
  label: string;
  value: string;
  unit?: string;
  title?: string;
  placeholder?: string;
  size?: number;
  isNumeric?: boolean; // the keyboard of a phone
  isDisabled?: boolean;
  // Returns the reason if the text was refused, else null.
  commit(value: string): Promise<string | null> | string | null;
}

export function TextField({ label, value, unit = '', title, placeholder, size, isNumeric, isDisabled, commit }: Field) {
  const typed = useSignal<string | null>(null);
  const problem = useSignal<string | null>(null);
  const input = useRef<HTMLInputElement>(null);
  // Esc takes back what was typed, and leaves the field: the next key is one of the page.
  useEffect(
    () =>
      addFront({
        isOpen: () => typed.peek() !== null && document.activeElement === input.current,
        close: () => {
          typed.value = null;
          problem.value = null;
          input.current?.blur();
        },
      }),
    [],
  );
  const send = async () => {
    const text = typed.peek();
    if (text === null) return;
    problem.value = text.trim() === value ? null : await commit(text.trim());
    // A text that was refused stays, so that it can be corrected.
    if (problem.peek() === null && typed.peek() === text) typed.value = null;
  };
  return (
    <label class="number-field" title={title}>
      <span>{label}</span>
      <input
        ref={input}
        type="text"
        inputMode={isNumeric === true ? 'decimal' : 'text'}
        size={size}
        placeholder={placeholder}
        autocomplete="off"
        aria-label={unit === '' ? label : `${label} in ${unit}`}
        value={typed.value ?? value}
        disabled={isDisabled === true}
        aria-invalid={problem.value !== null}
        onInput={(event) => (typed.value = event.currentTarget.value)}
        onBlur={() => void send()}
        onKeyDown={(event) => {
          if (event.key === 'Enter') void send();
        }}
      />
      {unit !== '' && <span class="unit">{unit}</span>}
      {problem.value !== null && (
        <span class="problem" role="alert">
          {problem.value}
        </span>
      )}
    </label>
  );
}
