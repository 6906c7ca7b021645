// The newest scenario that the teacher of a class has handed out, until the person has opened or dismissed it.
import { signal } from '@preact/signals';
import { newestUnseen, readSeen, storeSeen } from '../state/handed_out.js';
import type { Stores } from '../view/robot_view.js';

const seen = signal(readSeen(location.pathname, sessionStorage));

export function HandedOutBand({ app }: { app: Stores<'shownPage' | 'state' | 'wantedScenario'> }) {
  const newest = newestUnseen(app.state.handedOut.value, seen.value);
  if (newest === null) return null;
  const note = () => {
    seen.value = newest.file;
    storeSeen(location.pathname, newest.file, sessionStorage);
  };
  const open = () => {
    note();
    app.wantedScenario.value = newest.file;
    app.shownPage.value = 'make';
  };
  const isHolder = app.state.isHolder.value;
  return (
    <div class="band question" role="alert" data-testid="handed-out">
      <span>Your teacher has handed out “{newest.title}”.</span>
      <button type="button" class="primary" disabled={!isHolder} title={isHolder ? newest.file : 'Take control to open it.'} onClick={open}>
        Open
      </button>
      <button type="button" title="It stays in your folder: page Make, Open …" onClick={note}>
        Later
      </button>
    </div>
  );
}
