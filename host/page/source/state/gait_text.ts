// The comparison of the modules with the gait, in words.
import type { GaitComparison } from '../wire/messages.js';

export function describeGait(gait: GaitComparison | null): { text: string; tone: 'good' | 'bad' | 'quiet' } {
  const { compared, differences, missing } = gait ?? { compared: 0, differences: 0, missing: 0 };
  const number = (value: number) => value.toLocaleString('en');
  if (compared === 0 && missing === 0) {
    return { text: 'No state frame compared yet.', tone: 'quiet' };
  }
  return {
    text: `${number(compared)} compared, ${number(differences)} ${differences === 1 ? 'difference' : 'differences'}, ${number(missing)} missing`,
    tone: differences > 0 || compared === 0 ? 'bad' : 'good',
  };
}
