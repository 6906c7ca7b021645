// A line for learners, which their pages show.
import { useSignal } from '@preact/signals';
import { close, Dialog } from '../panels/dialog.js';
import type { ClassSeat } from '../wire/messages.js';
import type { ClassApp } from './class_app.js';
import { LearnerChoice, seatsOf } from './learner_choice.js';

const mostCharacters = 200;

export function MessageDialog({ app, seat }: { app: ClassApp; seat: ClassSeat | null }) {
  const text = useSignal('');
  const problem = useSignal('');
  const chosen = useSignal<ReadonlySet<number> | null>(seat === null ? null : new Set([seat.seat]));
  const isReady = text.value.trim() !== '' && chosen.value?.size !== 0;
  const send = async () => {
    try {
      await app.operations.ask('class.message', { text: text.value.trim(), ...seatsOf(chosen) });
      close();
    } catch (error) {
      problem.value = (error as Error).message;
    }
  };
  return (
    <Dialog title={seat === null ? 'Message' : `Message to ${seat.name}`}>
      <form
        class="class-form"
        onSubmit={(event) => {
          event.preventDefault();
          if (isReady) void send();
        }}
      >
        <label for="message-text">Text</label>
        <input
          id="message-text"
          type="text"
          autoComplete="off"
          placeholder="Look at the board"
          maxLength={mostCharacters}
          value={text.value}
          onInput={(event) => (text.value = event.currentTarget.value)}
        />
        {seat === null && <LearnerChoice learners={app.room.value?.learners ?? []} chosen={chosen} />}
        <p class="problem" role="alert">
          {problem.value}
        </p>
        <div class="fields">
          <button type="submit" class="primary" disabled={!isReady}>
            Send
          </button>
          <button type="button" onClick={close}>
            Cancel
          </button>
        </div>
      </form>
    </Dialog>
  );
}
