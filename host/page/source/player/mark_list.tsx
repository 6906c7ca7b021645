// The list of changes and failures of the run: a click on one goes to its time.
import type { PlayedRecording } from './player_app.js';

const kinds = { change: 'change', fault: 'fault', restart: 'module', move: 'move', loss: 'loss' } as const;

export function MarkList({ app }: { app: PlayedRecording }) {
  // Lost frames are shown only on the time line, because some recordings have them everywhere.
  const marks = app.recording.marks.filter(({ kind }) => kind !== 'loss');
  if (marks.length === 0) {
    return null;
  }
  return (
    <section class="panel mark-panel" aria-label="Changes">
      <h2>Changes</h2>
      <ul class="mark-list" data-testid="marks">
        {marks.map((mark, i) => (
          <li key={i}>
            <button type="button" onClick={() => app.time.pick(mark.tick)} title={`To tick ${mark.tick}`}>
              <i class={`time-mark ${mark.kind}`} />
              <span class="value">{(mark.tick / app.tickRate).toFixed(2)} s</span>
              <span class="unit">{kinds[mark.kind]}</span>
              <span class="text">{mark.text}</span>
            </button>
          </li>
        ))}
      </ul>
    </section>
  );
}
