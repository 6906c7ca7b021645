// A row of the table of modules in words.
import { moduleState } from '../state/module_text.js';
import type { ModuleRow } from './module_rows.js';

export type Tone = 'good' | 'quiet' | 'bad' | '';

export function stateText({ live, found }: ModuleRow): string {
  if (live?.silent === true) return 'silent';
  if (live === null && found?.answers === false) return 'no answer';
  return live?.state ?? found?.state ?? 'not driven';
}

export function driveText({ live, found }: ModuleRow): string {
  return live?.drive ?? found?.drive ?? '–';
}

// What is wrong with the module, and what to do; null: nothing is.
export function troubleOf({ live, found, isOtherModule, joint }: ModuleRow): { text: string; advice: string } | null {
  if (live !== null && moduleState(live).tone === 'bad') {
    return { text: moduleState(live).text, advice: live.advice ?? (live.silent ? 'Look at its power and its cable.' : '') };
  }
  if (live === null && found?.answers === false) {
    return { text: 'does not answer', advice: 'Recover looks what it has.' };
  }
  if (isOtherModule) {
    return { text: `the robot's file names another module for ${joint?.name ?? 'it'}`, advice: 'Places gives the modules their node ids.' };
  }
  const register = found?.error_register ?? 0;
  return register === 0 ? null : { text: `error register ${register}`, advice: 'What is wrong? explains it.' };
}

export function measured(value: number | null | undefined, decimals: number): string {
  return value === null || value === undefined ? '–' : value.toFixed(decimals);
}

export const sensorNames = ['rear', 'front', 'rear, link in front', 'front, link in front'] as const;

// The sensors of a row that exist, as positions of their bits, from the tail to the head.
export function sensorsOf({ hasFrontSensors }: ModuleRow): number[] {
  return hasFrontSensors ? [0, 1, 2, 3] : [0, 1];
}

export function touchText(row: ModuleRow): string {
  if (row.touch === null) return 'not read';
  const pressed = sensorsOf(row).filter((bit) => ((row.touch ?? 0) >> bit) & 1);
  return pressed.length === 0 ? 'no sensor is pressed' : `pressed: ${pressed.map((bit) => sensorNames[bit]).join('; ')}`;
}
