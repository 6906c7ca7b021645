// To whom something goes: all learners, or some. They are buttons, because Space, which sets a check box, is STOP.
import type { Signal } from '@preact/signals-core';
import type { ClassSeat } from '../wire/messages.js';

// Null: all, also those who come later.
export type Chosen = Signal<ReadonlySet<number> | null>;

export function seatsOf(chosen: Chosen): { seats?: number[] } {
  return chosen.value === null ? {} : { seats: [...chosen.value] };
}

export function LearnerChoice({ learners, chosen }: { learners: readonly ClassSeat[]; chosen: Chosen }) {
  const toggle = (seat: number) => {
    const next = new Set(chosen.value ?? []);
    if (!next.delete(seat)) next.add(seat);
    chosen.value = next;
  };
  return (
    <div class="learner-choice" role="group" aria-label="To whom">
      <button type="button" aria-pressed={chosen.value === null} onClick={() => (chosen.value = null)}>
        All
      </button>
      {learners.map(({ seat, name }) => (
        <button key={seat} type="button" aria-pressed={chosen.value?.has(seat) === true} title={name} onClick={() => toggle(seat)}>
          <span>{name}</span>
        </button>
      ))}
    </div>
  );
}
