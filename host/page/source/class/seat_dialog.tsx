// What a teacher does with a seat rarely, and only after a second press.
import { useSignal } from '@preact/signals';
import { close, Dialog } from '../panels/dialog.js';
import type { ClassSeat } from '../wire/messages.js';
import type { ClassApp } from './class_app.js';

interface SeatAction {
  operation: 'class.let_in' | 'class.restart' | 'class.remove';
  title: string;
  text: string; // what happens
  isForTeacher: boolean; // also of the teacher's own robot
}

const seatActions: readonly SeatAction[] = [
  {
    operation: 'class.let_in',
    title: 'Let in again',
    text: 'This name may join once more, with the code, from another browser. The page that has the robot now loses it. Files stay.',
    isForTeacher: false,
  },
  {
    operation: 'class.restart',
    title: 'Start again',
    text: 'The program of this robot ends and starts anew: for a robot that hangs. What is not saved may be lost.',
    isForTeacher: true,
  },
  {
    operation: 'class.remove',
    title: 'Remove',
    text: 'The robot ends, and its name and place are free. The folder with the files stays.',
    isForTeacher: false,
  },
];

export function SeatDialog({ app, seat }: { app: ClassApp; seat: ClassSeat }) {
  const asked = useSignal<SeatAction | null>(null);
  const problem = useSignal('');
  const name = seat.seat === 0 ? 'My robot' : seat.name;
  const act = async ({ operation }: SeatAction) => {
    try {
      await app.operations.ask(operation, { seat: seat.seat });
      close();
    } catch (error) {
      problem.value = (error as Error).message;
    }
  };
  return (
    <Dialog title={asked.value === null ? name : `${asked.value.title}: ${name}?`}>
      <div class="class-form">
        {asked.value === null ? (
          seatActions
            .filter(({ isForTeacher }) => isForTeacher || seat.seat !== 0)
            .map((action) => (
              <div key={action.operation} class="seat-action">
                <button type="button" onClick={() => (asked.value = action)}>
                  {action.title} …
                </button>
                <span class="hint">{action.text}</span>
              </div>
            ))
        ) : (
          <>
            <p>{asked.value.text}</p>
            <p class="problem" role="alert">
              {problem.value}
            </p>
            <div class="fields">
              <button type="button" class="primary" onClick={() => void act(asked.value as SeatAction)}>
                {asked.value.title}
              </button>
              <button type="button" onClick={close}>
                Cancel
              </button>
            </div>
          </>
        )}
      </div>
    </Dialog>
  );
}
