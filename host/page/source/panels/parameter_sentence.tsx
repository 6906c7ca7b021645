// What a parameter changes, in one everyday sentence below its name. All of them can be hidden.
import { signal } from '@preact/signals';
import { splitHelp } from '../state/parameter_values.js';
import { storeChoice, storedChoice } from '../view/stored_choice.js';

const key = 'proleg.sentences';

export const sentencesAreShown = signal(storedChoice(key) !== 'hidden');

export function toggleSentences(): void {
  sentencesAreShown.value = !sentencesAreShown.value;
  storeChoice(key, sentencesAreShown.value ? 'shown' : 'hidden');
}

export function ParameterSentence({ help, id }: { help: string; id: string }) {
  if (!sentencesAreShown.value) return null;
  return (
    <p class="sentence" id={id}>
      {splitHelp(help).sentence}
    </p>
  );
}
