// A number that is sent when it is complete.
import { formatNumber, parseNumber } from '../../state/parameter_values.js';
import { TextField } from './text_field.js';

interface Field {
  label: string;
  value: number;
  unit?: string | undefined;
  title?: string | undefined;
  decimals?: number;
  isDisabled?: boolean;
  // Returns the reason if the value was refused, else null.
  commit(value: number): Promise<string | null> | string | null;
}

export function NumberField({ label, value, unit = '', title, decimals = 4, isDisabled = false, commit }: Field) {
  const shown = formatNumber(value, decimals);
  const send = (text: string) => {
    const number = parseNumber(text);
    if (typeof number === 'string') return number;
    return number === Number(shown) ? null : commit(number);
  };
  return <TextField label={label} value={shown} unit={unit} title={title ?? ''} size={8} isNumeric isDisabled={isDisabled} commit={send} />;
}
