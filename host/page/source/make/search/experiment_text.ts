// The texts of an experiment as the program reads them: with decimal points, and lists with blanks between their numbers.
import type { Experiment } from '../../wire/messages.js';

// A comma in front of a blank separates; any other one is decimal.
export function plainText(text: string): string {
  return text
    .replace(/[;]|,(?=\s|$)/g, ' ')
    .replaceAll(',', '.')
    .trim()
    .replace(/\s+/g, ' ');
}

function plainTexts<Part extends object>(part: Part): Part {
  return Object.fromEntries(Object.entries(part).map(([name, value]) => [name, typeof value === 'string' ? plainText(value) : (value as unknown)])) as Part;
}

export function plainExperiment(experiment: Experiment): Experiment {
  const { settings, parameters, objectives, trials, confirmation, racing } = experiment;
  return {
    ...experiment,
    settings: Object.fromEntries(Object.entries(plainTexts(settings)).filter(([, text]) => text !== '')),
    parameters: parameters.map(plainTexts),
    objectives: objectives.map((objective) => ({ ...plainTexts(objective), name: objective.name.trim(), terms: objective.terms.map(plainTexts) })),
    axes: experiment.axes.map(plainTexts),
    heading: plainText(experiment.heading),
    evaluations: plainText(experiment.evaluations),
    seed: experiment.seed.trim(),
    trials: trials && plainTexts(trials),
    confirmation: confirmation && plainTexts(confirmation),
    racing: racing && plainTexts(racing),
  };
}

// The name, or with a number behind it, that no search has. taken: paths of their folders.
export function freeName(wanted: string, taken: readonly string[]): string {
  const used = new Set(taken.map((name) => name.split('/').at(-1)));
  let name = wanted;
  for (let number = 2; used.has(name); number += 1) name = `${wanted}_${number}`;
  return name;
}

// A name that says what is searched how: "cma_es_distance".
export function proposedName(experiment: Experiment, taken: readonly string[]): string {
  const words = (text: string) => text.replace(/([a-z])([A-Z])/g, '$1_$2').toLowerCase();
  const method = experiment.algorithm === '' ? words(experiment.method) : experiment.algorithm;
  return freeName([method, experiment.objectives[0]?.terms[0]?.measure].filter(Boolean).join('_'), taken);
}
