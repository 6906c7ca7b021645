// How long a search may take, in words; and the number of evaluations that this is.
import type { Experiment, SearchMethod } from '../../wire/messages.js';

export const timePresets = [
  { name: 'half_minute', title: 'half a minute', seconds: 30 },
  { name: 'five_minutes', title: 'five minutes', seconds: 300 },
  { name: 'night', title: 'a night', seconds: 8 * 3600 },
] as const;

export type TimePreset = (typeof timePresets)[number]['name'];

const mostEvaluations = 1e9;
const mostGenerations = 1e6;

// A number with two digits that are not 0, at least 1.
export function evaluationsIn(seconds: number, evaluationSeconds: number): number {
  const count = Math.min(mostEvaluations, Math.max(1, Math.floor(seconds / Math.max(1e-9, evaluationSeconds))));
  const unit = 10 ** Math.max(0, String(count).length - 2);
  return Math.floor(count / unit) * unit;
}

// The experiment with so many evaluations. Generations do not end it before.
export function withEvaluations(experiment: Experiment, method: SearchMethod | undefined, evaluations: number): Experiment {
  const setting = (name: string) => method?.settings.find((each) => each.name === name);
  const valueOf = (name: string) => Number(experiment.settings[name] || setting(name)?.default) || 1;
  const settings = { ...experiment.settings };
  if (setting('generations') !== undefined && setting('popsize') !== undefined && valueOf('generations') * valueOf('popsize') < evaluations) {
    settings['generations'] = String(Math.min(mostGenerations, Math.ceil(evaluations / valueOf('popsize'))));
  }
  return { ...experiment, settings, evaluations: String(evaluations) };
}

// What the duration of an evaluation depends on. `scenario`: the run of the draft and what else makes it slow.
export function durationKey(experiment: Experiment, engine: string | null, workers: number, scenario: unknown): string {
  return JSON.stringify([engine, workers, experiment.trials, experiment.racing, scenario]);
}
