// What a touch test has seen of the sensors of a module. A sensor works if it was seen released, then pressed, then released:
// one that is stuck, pressed or released, does not do this.

export type TouchVerdict = 'not yet' | 'pressed' | 'stuck' | 'works';

// Each has a bit for each sensor.
export interface TouchWatch {
  released: number; // was released
  pressed: number; // was pressed after that
  works: number; // was released after that, too
  present: number; // pressed now
}

// After another reading of the sensors. `before`: null: it is the first one.
export function touchSeen(before: TouchWatch | null, touch: number): TouchWatch {
  const { released, pressed, works } = before ?? { released: 0, pressed: 0, works: 0 };
  return { released: released | ~touch, pressed: pressed | (released & touch), works: works | (pressed & ~touch), present: touch };
}

export function touchVerdict(watch: TouchWatch | null, bit: number): TouchVerdict {
  const has = (bits: number) => ((bits >> bit) & 1) === 1;
  if (watch === null) return 'not yet';
  if (has(watch.works)) return 'works';
  if (has(watch.pressed)) return 'pressed';
  return has(watch.present) && !has(watch.released) ? 'stuck' : 'not yet';
}
