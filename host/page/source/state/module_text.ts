// A module on the bus in words.
import type { BusDocument, BusModule, RobotDocument } from '../wire/messages.js';

export interface ModuleState {
  text: string;
  tone: 'good' | 'quiet' | 'bad';
}

// `states` of NMT and of the drive (CiA 402) as the module reports them; trouble first.
export function moduleState(module: BusModule): ModuleState {
  if (module.silent) {
    return { text: 'silent', tone: 'bad' };
  }
  if (module.fault !== null) {
    return { text: module.fault, tone: 'bad' };
  }
  if (module.stop_confirmed === false) {
    return { text: 'STOP not confirmed', tone: 'bad' };
  }
  const text = module.drive ?? module.state ?? 'not known';
  return { text, tone: module.drive === 'operation enabled' ? 'good' : 'quiet' };
}

const nearLimit = 0.8; // share of the limit

// A servo's current in mA. A mark is a word, too: not everybody sees colours. The limit: 0: off; null: not known.
export function currentState(current: number | null, limit: number | null): { text: string; tone: '' | 'near-limit' | 'above-limit' } {
  const text = current === null ? '–' : current.toFixed(0);
  if (current === null || limit === null || limit === 0 || current < nearLimit * limit) {
    return { text, tone: '' };
  }
  return current > limit ? { text: `${text} above limit`, tone: 'above-limit' } : { text: `${text} near limit`, tone: 'near-limit' };
}

export function currentLimitOf(bus: BusDocument | null, joint: number): number | null {
  return bus?.modules.find((module) => module.joint === joint)?.current_limit ?? null;
}

export function moduleName(module: BusModule, robot: Pick<RobotDocument, 'joints'> | null): string {
  return module.joint === null ? `node ${module.node}` : (robot?.joints[module.joint]?.name ?? `node ${module.node}`);
}

export interface Trouble {
  node: number;
  text: string;
  advice: string;
}

// What is wrong with modules, and what to do.
export function troublesOf(bus: BusDocument | null, robot: Pick<RobotDocument, 'joints'> | null): Trouble[] {
  return (bus?.modules ?? []).flatMap((module) => {
    const { text, tone } = moduleState(module);
    if (tone !== 'bad') {
      return [];
    }
    const advice = module.advice ?? (module.silent ? 'Look at its power and its cable.' : '');
    return [{ node: module.node, text: `${moduleName(module, robot)}: ${text}`, advice }];
  });
}
