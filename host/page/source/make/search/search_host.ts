// What the part Search needs of the page Make.
import type { ReadonlySignal, Signal } from '@preact/signals-core';
import type { Stores } from '../../view/robot_view.js';
import type { DraftDocument, RobotDocument } from '../../wire/messages.js';
import type { MotionPair } from './motion.js';

export interface SearchHost {
  readonly page: Stores<'operations' | 'state'>;
  readonly draft: ReadonlySignal<DraftDocument | null>;
  readonly draftRobot: ReadonlySignal<RobotDocument | null>;
  readonly isSearchShown: ReadonlySignal<boolean>; // the part is in front, and the program is connected
  readonly chosenSearch: Signal<string | null>; // its name
  readonly chosenSweep: Signal<string | null>; // its name; then no search is chosen
  readonly motion: Signal<MotionPair | null>; // what the 3D view plays
  // The reason why nothing can be changed; null: it can.
  obstacle(): string | null;
  // Puts values into the draft as one change. Returns the reason if it was refused, else null.
  setValues(words: readonly string[], label: string): Promise<string | null>;
}
