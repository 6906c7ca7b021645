// How large a mesh is: files have no units, so a person says which, and gets a suggestion.
import type { SentMesh } from '../wire/messages.js';

export const units = [
  { name: 'm', metres: 1 },
  { name: 'mm', metres: 0.001 },
  { name: 'cm', metres: 0.01 },
  { name: 'inch', metres: 0.0254 },
] as const;

export type Purpose = 'world' | 'module';

// Longest sides that an object, or a link of a robot, usually has, in metres.
const usual: Record<Purpose, readonly [number, number]> = { world: [0.02, 3], module: [0.01, 0.5] };

export function sidesOf({ lowest, highest }: Pick<SentMesh, 'lowest' | 'highest'>, factor: number): [number, number, number] {
  const side = (axis: 0 | 1 | 2) => (highest[axis] - lowest[axis]) * factor;
  return [side(0), side(1), side(2)];
}

export function isPlausible(mesh: Pick<SentMesh, 'lowest' | 'highest'>, factor: number, purpose: Purpose): boolean {
  const longest = Math.max(...sidesOf(mesh, factor));
  const [least, most] = usual[purpose];
  return longest >= least && longest <= most;
}

// The unit with which the mesh has a usual size; null: there is none.
export function suggestedUnit(mesh: Pick<SentMesh, 'lowest' | 'highest'>, purpose: Purpose): (typeof units)[number] | null {
  return units.find(({ metres }) => isPlausible(mesh, metres, purpose)) ?? null;
}

// "60 × 40 × 20 mm", with three digits.
export function sizeText(sides: readonly number[]): string {
  const longest = Math.max(...sides);
  const unit = longest >= 1000 ? ({ name: 'km', metres: 1000 } as const) : longest >= 1 ? units[0] : units[1];
  const text = (side: number) => {
    const value = Number((side / unit.metres).toPrecision(3));
    return Math.abs(value) < 1e-3 && value !== 0 ? value.toExponential(0) : String(value);
  };
  return `${sides.map(text).join(' × ')} ${unit.name}`;
}

// The sides after turns of 90 degrees about x, then y, then z.
export function turnedSides(sides: readonly [number, number, number], [x, y, z]: readonly [number, number, number]): [number, number, number] {
  let [a, b, c] = sides;
  if (x % 2 === 1) [b, c] = [c, b];
  if (y % 2 === 1) [a, c] = [c, a];
  if (z % 2 === 1) [a, b] = [b, a];
  return [a, b, c];
}
