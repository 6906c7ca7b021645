// The values of a candidate beside those of the draft. A candidate is a list of words as for `set`: "1.amplitude:J2=30".
import { formatNumber } from '../../state/parameter_values.js';
import type { AlgorithmDocument, DraftDocument } from '../../wire/messages.js';
import { parameterOf } from './experiment_defaults.js';

const decimals = 6;

export interface WordValue {
  name: string; // as in the word
  unit: string;
  candidate: string;
  draft: string; // "30 to 40" if its joints differ; empty: the draft has no such parameter
  isSame: boolean;
}

interface Word {
  module: number | null; // position in the behaviour; null: the word does not say
  parameter: string;
  joints: string[] | null; // null: all of the module
  name: string;
  value: number;
}

export function parseWord(word: string): Word | null {
  const match = /^((?:([1-9])\.)?([^.:=]+)(?::(.+))?)=([^=]+)$/.exec(word);
  const value = Number(match?.[5]);
  if (match === null || Number.isNaN(value)) return null;
  const [, name, module, parameter, joints] = match;
  return { module: module === undefined ? null : Number(module) - 1, parameter: parameter!, joints: joints?.split(',') ?? null, name: name!, value };
}

// The raw values of the draft that a word names, and what they are multiplied by.
function draftValues(word: Word, draft: DraftDocument, algorithms: readonly AlgorithmDocument[]) {
  const names = draft.robot.joints.map(({ name }) => name);
  for (const [number, module] of draft.behaviour.modules.entries()) {
    const raw = module.values[word.parameter];
    const parameter = parameterOf(algorithms, module, word.parameter);
    if ((word.module !== null && word.module !== number) || raw === undefined || parameter === undefined) continue;
    const places = word.joints?.map((joint) => module.joints.indexOf(names.indexOf(joint))) ?? raw.map((_, place) => place);
    if (places.length > 0 && places.every((place) => place >= 0)) return { raw: places.map((place) => raw[place]!), parameter };
  }
  return null;
}

export function wordValues(words: readonly string[], draft: DraftDocument, algorithms: readonly AlgorithmDocument[]): WordValue[] {
  return words.flatMap((text) => {
    const word = parseWord(text);
    if (word === null) return [];
    const found = draftValues(word, draft, algorithms);
    const candidate = formatNumber(word.value, decimals);
    if (found === null) return [{ name: word.name, unit: '', candidate, draft: '', isSame: false }];
    const { raw, parameter } = found;
    const values = raw.map((each) => each * parameter.scale);
    const [low, high] = [Math.min(...values), Math.max(...values)].map((value) => formatNumber(value, decimals));
    return [
      {
        name: word.name,
        unit: parameter.unit,
        candidate,
        draft: low === high ? low! : `${low} to ${high}`,
        isSame: values.every((value) => Math.abs(value - word.value) <= Math.abs(parameter.scale)),
      },
    ];
  });
}
