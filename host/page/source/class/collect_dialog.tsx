// Copies the finished recordings of all learners to the teacher's own robot.
import { useSignal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import { close, Dialog } from '../panels/dialog.js';
import type { CollectResult } from '../wire/messages.js';
import type { ClassApp } from './class_app.js';
import { collectText, seatAddress } from './tile_text.js';

export function CollectDialog({ app }: { app: ClassApp }) {
  const text = useSignal('Copying …');
  const areThere = useSignal(false);
  const failures = useSignal<readonly string[]>([]);
  const room = app.room.value;
  const nameOf = (seat: number) => room?.learners.find((learner) => learner.seat === seat)?.name ?? `seat ${seat}`;
  useEffect(() => {
    app.operations.ask('class.collect', {}).then(
      (value) => {
        const result = value as CollectResult;
        text.value = collectText(result);
        areThere.value = result.copied + result.known > 0;
        failures.value = result.failed.map(({ seat, error }) => `${nameOf(seat)}: ${error}`);
      },
      (error: Error) => (text.value = error.message),
    );
  }, []);
  return (
    <Dialog title="Collect recordings">
      <div class="class-form">
        <p role="status" data-testid="collected">
          {text.value}
        </p>
        {failures.value.map((failure) => (
          <p key={failure} class="problem">
            {failure}
          </p>
        ))}
        {areThere.value && <p class="hint">They are in the Recordings of your own robot.</p>}
        <div class="fields">
          {areThere.value && room?.teacher != null && (
            <a class="button primary" href={seatAddress(room.teacher, 'recordings')} target="_blank" rel="noopener">
              Show them
            </a>
          )}
          <button type="button" onClick={close}>
            Done
          </button>
        </div>
      </div>
    </Dialog>
  );
}
