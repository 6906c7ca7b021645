// An experiment that a person begins with: good defaults, so that two or three clicks start a sensible search.
import { formatNumber, formatRaw } from '../../state/parameter_values.js';
import type { AlgorithmDocument, AlgorithmParameter, BehaviourModule, ChosenParameter, DraftDocument, Experiment, ExperimentAxis, Objective, SearchMethod } from '../../wire/messages.js';

const fewestSteps = 240; // of a range, if it is not of whole numbers
const usualMethod = 'cmaEs';
const usualMeasure = 'distance';
const usualEvaluations = '500'; // until a preset has measured how long they take
const usualRestart = '5'; // generations without a gain

// The greatest step that is 1, 2, 2.5 or 5 times a power of ten, and makes at least so many steps of a range.
export function rangeStep(size: number): number {
  if (!(size > 0)) return 1;
  const finest = size / fewestSteps;
  const power = 10 ** Math.floor(Math.log10(finest) + 1e-9);
  return ([5, 2.5, 2].find((factor) => factor * power <= finest * (1 + 1e-9)) ?? 1) * power;
}

// The range of a parameter for a search: the useful part, in steps that fit between its ends.
export function defaultRange(parameter: AlgorithmParameter): Pick<ChosenParameter, 'lower' | 'upper' | 'step'> {
  const useful = parameter.useful ?? [parameter.minimum, parameter.maximum];
  const [low, high] = useful.map((raw) => Number(formatRaw(raw, parameter))) as [number, number];
  const isWhole = parameter.scale === 1;
  const step = isWhole ? Math.max(1, Math.round(rangeStep(high - low))) : rangeStep(high - low);
  const steps = Math.max(1, Math.floor((high - low) / step + 1e-6));
  const text = (value: number) => formatNumber(value, 9);
  return { lower: text(low), upper: text(low + steps * step), step: text(step) };
}

export function parameterOf(algorithms: readonly AlgorithmDocument[], module: BehaviourModule | undefined, name: string): AlgorithmParameter | undefined {
  return algorithms.find((algorithm) => algorithm.name === module?.algorithm)?.parameters.find((parameter) => parameter.name === name);
}

// A parameter of a module as it is added to an experiment: each joint has its own value.
export function newParameter(module: number, parameter: AlgorithmParameter): ChosenParameter {
  return { module, parameter: parameter.name, joints: null, same: false, ...defaultRange(parameter), with_lower: true, with_upper: true, set: null };
}

function hasUsefulRange({ useful, minimum, maximum }: AlgorithmParameter): boolean {
  return useful !== undefined && (useful[0] !== minimum || useful[1] !== maximum);
}

// The amplitude of the first module; else the first parameter with a useful range; else the first one.
function firstParameter(draft: DraftDocument, algorithms: readonly AlgorithmDocument[]): ChosenParameter[] {
  const all = draft.behaviour.modules.flatMap(({ algorithm, joints }, module) =>
    joints.length === 0 ? [] : (algorithms.find(({ name }) => name === algorithm)?.parameters ?? []).map((parameter) => ({ module, parameter })),
  );
  const found =
    all.find(({ module, parameter }) => module === 0 && parameter.name === 'amplitude') ?? all.find(({ parameter }) => hasUsefulRange(parameter)) ?? all[0];
  return found === undefined ? [] : [newParameter(found.module, found.parameter)];
}

export function newObjective(measure: string): Objective {
  return { name: '', goal: '', failed: '', terms: [{ measure, weight: '' }] };
}

// The axes with which a map begins: how high the robot rises, and which share of the stride its links are on the ground.
export const usualAxes: readonly ExperimentAxis[] = [
  { measure: 'height', lowest: '0', highest: '0.05', cells: '25' },
  { measure: 'duty_factor', lowest: '0.2', highest: '0.4', cells: '20' },
];

// What changes in an experiment that gets another method.
export function withMethod(experiment: Experiment, method: SearchMethod): Partial<Experiment> {
  const { settings, axes } = experiment;
  return {
    method: method.tag,
    algorithm: method.algorithm ?? '',
    settings: settingsFor(method, settings),
    axes: method.has_map && axes.length === 0 ? [...usualAxes] : axes,
  };
}

// The settings with which a method begins: those that were typed for another one, if it has them. A method that can restart
// does: else it ends on the first summit that it finds.
export function settingsFor(method: SearchMethod | undefined, typed: Record<string, string>): Record<string, string> {
  const names = method?.settings.map(({ name }) => name) ?? [];
  const known = Object.fromEntries(Object.entries(typed).filter(([name]) => names.includes(name)));
  return names.includes('restartAfter') && known['restartAfter'] === undefined ? { ...known, restartAfter: usualRestart } : known;
}

export function newExperiment(draft: DraftDocument, algorithms: readonly AlgorithmDocument[], methods: readonly SearchMethod[]): Experiment {
  const method = methods.find(({ tag }) => tag === usualMethod) ?? methods[0];
  return {
    method: method?.tag ?? usualMethod,
    algorithm: method?.algorithm ?? '',
    settings: settingsFor(method, {}),
    parameters: firstParameter(draft, algorithms),
    objectives: [newObjective(usualMeasure)],
    axes: [],
    heading: '',
    evaluations: usualEvaluations,
    seed: '1',
    reuse: true,
    trials: null,
    confirmation: null,
    racing: null,
  };
}

// The experiment without what the draft does not have: another robot, or another gait.
export function fitToDraft(experiment: Experiment, draft: DraftDocument): Experiment {
  const parameters = experiment.parameters.flatMap((parameter) => {
    const module = draft.behaviour.modules[parameter.module];
    if (module?.values[parameter.parameter] === undefined) return [];
    const joints = parameter.joints?.filter((joint) => module.joints.includes(joint)) ?? null;
    return joints?.length === 0 ? [] : [{ ...parameter, joints }];
  });
  return { ...experiment, parameters };
}
