// One of several values, with a text for each.

interface Field<Value extends string> {
  label: string;
  value: Value;
  texts: Record<Value, string>;
  name?: string; // for screen readers, if it is not the label
  title?: string;
  isDisabled: boolean;
  commit(value: Value): void;
}

export function ChoiceField<Value extends string>({ label, value, texts, name: spoken, title, isDisabled, commit }: Field<Value>) {
  return (
    <label class="number-field" title={title}>
      {label !== '' && <span>{label}</span>}
      <select aria-label={spoken} value={value} disabled={isDisabled} onChange={(event) => commit(event.currentTarget.value as Value)}>
        {(Object.keys(texts) as Value[]).map((name) => (
          <option key={name} value={name}>
            {texts[name]}
          </option>
        ))}
      </select>
    </label>
  );
}
