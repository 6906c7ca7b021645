// Controls for playing and speed, the time line, and the time of the cursor.
import { useEffect, useRef } from 'preact/hooks';
import { onFrame } from '../view/frame_clock.js';
import { pauseIcon, runIcon } from '../panels/icons.js';
import { speeds } from '../state/playback.js';
import type { PlayedRecording } from './player_app.js';
import { Timeline } from './timeline.js';

function Position({ app }: { app: PlayedRecording }) {
  const tick = useRef<HTMLElement>(null);
  const time = useRef<HTMLElement>(null);
  useEffect(
    () =>
      onFrame(() => {
        const text = String(app.time.cursor.peek());
        if (tick.current !== null && time.current !== null && tick.current.textContent !== text) {
          tick.current.textContent = text;
          time.current.textContent = `${(Number(text) / app.tickRate).toFixed(2)} s`;
        }
      }),
    [],
  );
  return (
    <dl class="figures">
      <div>
        <dt>tick</dt>
        <dd ref={tick} data-testid="tick" />
      </div>
      <div>
        <dt>time</dt>
        <dd ref={time} data-testid="time" />
      </div>
    </dl>
  );
}

export function PlaybackControls({ app }: { app: PlayedRecording }) {
  const { time } = app;
  const isPlaying = time.isPlaying.value;
  return (
    <section class="run-controls" aria-label="Playback">
      <button type="button" class="primary run" onClick={() => time.toggle()} title="Play, or pause (Space)">
        {isPlaying ? pauseIcon : runIcon} {isPlaying ? 'Pause' : 'Play'}
      </button>
      <label>
        Speed{' '}
        <select
          value={String(time.speed.value)}
          onChange={(event) => (time.speed.value = Number(event.currentTarget.value))}
          title="Recorded seconds in a second (- and +)"
        >
          {speeds.map((speed) => (
            <option key={speed} value={String(speed)}>
              × {speed}
            </option>
          ))}
        </select>
      </label>
      <Timeline app={app} />
      <Position app={app} />
      {time.part.value !== null && (
        <button type="button" onClick={() => (time.part.value = null)} title="Strip and plots show the whole run (W)">
          Whole run
        </button>
      )}
    </section>
  );
}
