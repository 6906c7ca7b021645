// One of several values, with a text for each.

interface Field<Value extends string> {
  label: string;
  value: Value;
  texts: Record<Value, string>;
  title?: string;
  isDisabled: boolean;
  commit(value: Value): void;
}

export function ChoiceField<Value extends string>({ label, value, texts, title, isDisabled, commit }: Field<Value>) {
  return (
    <label class="number-field" title={title}>
      <span>{label}</span>
      <select value={value} disabled={isDisabled} onChange={(event) => commit(event.currentTarget.value as Value)}>
        {(Object.keys(texts) as Value[]).map((name) => (
          <option key={name} value={name}>
            {texts[name]}
          </option>
        ))}
      </select>
    </label>
  );
}
