// One line about an update under the running program or under this page.
import type { Stores } from '../view/robot_view.js';
import type { ProgramDocument } from '../wire/messages.js';

// `isOther`: this page began with another program than the one that it is connected to now. `isSeat`: the robot of somebody in a
// class, who cannot start the program.
export function describeUpdate(program: ProgramDocument | null, isOther: boolean, isSeat: boolean): string | null {
  if (isOther) return 'The program is another version now, and this page may not fit it. Reload the page.';
  if (program?.is_other_version === true || (isSeat && program?.is_replaced === true)) {
    return 'Proleg was updated while the class runs. Save your work. Your teacher has to start the class again.';
  }
  if (program?.is_replaced === true) {
    return 'Proleg was updated, or removed, while this program runs. It goes on; searches and other commands that it starts are of the new version. Save your work, end it, and start “proleg ui” again.';
  }
  return null;
}

export function ProgramBand({ app, isSeat }: { app: Stores<'state'>; isSeat: boolean }) {
  const { state } = app;
  const isOther = state.isOtherProgram.value;
  const text = describeUpdate(state.program.value, isOther, isSeat);
  if (text === null || !state.isConnected.value) return null;
  return (
    <div class="band info" role="status" data-testid="program-band">
      <span>{text}</span>
      {isOther && (
        <button type="button" class="primary" onClick={() => location.reload()}>
          Reload
        </button>
      )}
    </div>
  );
}
