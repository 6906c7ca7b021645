// The time window of strip and plots, the way back to live, markers and loop.
import { useEffect } from 'preact/hooks';
import { frozenText } from '../state/time_view.js';
import { onFrame } from '../view/frame_clock.js';
import type { Stores } from '../view/robot_view.js';
import { closeIcon } from './icons.js';

const windows = [2, 5, 10, 30, 60, 120]; // seconds

const longestPause = 250; // milliseconds between two frames; a longer pause comes from a hidden tab and does not count as playing time

function LoopControls({ app }: { app: Stores<'marks' | 'newestTick' | 'tickRate'> }) {
  const { marks } = app;
  const { from, to } = marks.loop.value;
  const text = (tick: number | null, key: string) => (tick === null ? key : `${(tick / app.tickRate).toFixed(2)} s`);
  useEffect(() => {
    let last: number | null = null;
    return onFrame((now) => {
      const passed = last === null ? 0 : Math.min(longestPause, now - last);
      last = now;
      marks.play((passed / 1000) * app.tickRate, app.newestTick);
    });
  }, []);
  if (from === null && to === null) {
    return null;
  }
  return (
    <span class="loop" role="group" aria-label="Loop" data-testid="loop">
      loop {text(from, '[')} to {text(to, ']')}
      {marks.range.value !== null && (
        <button type="button" onClick={() => marks.playOrPause(app.newestTick)} title="Play or pause the loop (Shift + P)">
          {marks.isPlaying.value ? 'Pause loop' : 'Play loop'}
        </button>
      )}
      <button type="button" class="icon-button" aria-label="Remove the loop" onClick={() => marks.removeLoop()}>
        {closeIcon}
      </button>
    </span>
  );
}

function MarkerList({ app }: { app: Stores<'marks' | 'newestTick' | 'tickRate'> }) {
  const { marks } = app;
  if (marks.markers.value.length === 0) {
    return null;
  }
  return (
    <ul class="markers" aria-label="Markers" data-testid="markers">
      {marks.markers.value.map(({ number, tick, name }) => (
        <li key={number}>
          <input
            type="text"
            size={Math.max(3, name.length)}
            aria-label="Name of the marker"
            value={name}
            onChange={(event) => marks.rename(number, event.currentTarget.value)}
          />
          <button type="button" title="Show this time" onClick={() => marks.jumpTo(number, app.newestTick)}>
            {(tick / app.tickRate).toFixed(2)} s
          </button>
          <button type="button" class="icon-button" aria-label={`Remove the marker ${name}`} onClick={() => marks.remove(number)}>
            {closeIcon}
          </button>
        </li>
      ))}
    </ul>
  );
}

export function TimeControls({ app }: { app: Stores<'marks' | 'newestTick' | 'state' | 'tickRate' | 'time'> }) {
  const { time } = app;
  const rate = app.tickRate;
  const seconds = time.window.value / rate;
  const isLive = time.isLive.value;
  const cursor = time.cursor.value;
  const isConnected = app.state.isConnected.value;
  return (
    <div class="time-controls" role="group" aria-label="Time">
      <button
        type="button"
        class={!isLive ? 'live-mark primary' : isConnected ? 'live-mark is-live' : 'live-mark'}
        aria-pressed={isLive}
        onClick={() => (isLive ? time.freeze(app.newestTick) : time.goLive())}
        title={isLive ? 'Freeze the view (P); the robot goes on' : 'Back to live (L)'}
        data-testid="live"
      >
        {!isLive ? 'Return to live (L)' : isConnected ? '● live' : '○ no new data'}
      </button>
      {!isLive && (
        <span class="frozen" data-testid="frozen">
          {frozenText(app.state.session.value?.state)}
        </span>
      )}
      <LoopControls app={app} />
      {cursor !== null && <span class="cursor-time">cursor at {(cursor / rate).toFixed(2)} s</span>}
      <span class="space" />
      <label for="window">Window</label>
      <select
        id="window"
        value={String(windows.find((candidate) => Math.abs(candidate - seconds) < 0.01) ?? 10)}
        onChange={(event) => {
          time.window.value = Number(event.currentTarget.value) * rate;
          time.goLive();
        }}
      >
        {windows.map((candidate) => (
          <option key={candidate} value={String(candidate)}>
            {candidate} s
          </option>
        ))}
      </select>
      <MarkerList app={app} />
    </div>
  );
}
