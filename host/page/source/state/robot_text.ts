// Axes, order of joints and algorithms in words. In files of robots that lie along y, 1 0 0 is pitch and 0 0 1 yaw.

const degree = Math.PI / 180;
const nearly = 1e-4;

// The angle between pitch (0) and yaw (90) in degrees, from -90 (excluded) to 180; null: the axis is not across the robot.
export function axisAngle([x, y, z]: readonly [number, number, number]): number | null {
  const length = Math.hypot(x, y, z);
  if (length < nearly || Math.abs(y) > nearly * length) return null;
  const angle = Math.atan2(z, x) / degree;
  return Math.abs(angle) < nearly ? 0 : Math.round(angle * 1e4) / 1e4;
}

export function axisOfAngle(angle: number): [number, number, number] {
  const exact = (value: number) => (Math.abs(value) < 1e-9 ? 0 : Math.round(value * 1e6) / 1e6);
  return [exact(Math.cos(angle * degree)), 0, exact(Math.sin(angle * degree))];
}

// "p", "y", "30°" or "…" for another direction.
export function axisLetter(axis: readonly [number, number, number]): string {
  const angle = axisAngle(axis);
  if (angle === null) return '…';
  return angle === 0 ? 'p' : angle === 90 ? 'y' : `${angle}°`;
}

export function axisWord(axis: readonly [number, number, number]): string {
  const angle = axisAngle(axis);
  if (angle === null) return `axis ${axis.join(' ')}`;
  return angle === 0 ? 'pitch: up and down' : angle === 90 ? 'yaw: to the sides' : `turned by ${angle}° from pitch`;
}

// The positions of a list that begins at the head, from the tail on.
export function fromTail(count: number): number[] {
  return Array.from({ length: count }, (_, i) => count - 1 - i);
}

// "sinusoidal extended" for PatternGenerator_sinusoidal_extended.
export function algorithmTitle(name: string): string {
  return name.replace(/^(PatternGenerator|SensingModule)_/, '').replaceAll('_', ' ');
}

const engineTitles: Record<string, string> = { ode: 'ODE', reduced: 'the reduced engine', mujoco: 'MuJoCo' };
const engineTitle = (engine: string) => engineTitles[engine] ?? engine;

// Which engine has computed something, and that of the run, if it is another one.
export function engineText(engine: string, ofRun: string): string {
  return `by ${engineTitle(engine)}${engine === ofRun ? '' : `; Run has ${engineTitle(ofRun)}`}`;
}
