// The time window of strip and plots, and the way back to live.
import type { PageApp } from '../page_app.js';

const windows = [2, 5, 10, 30, 60, 120]; // seconds

export function TimeControls({ app }: { app: PageApp }) {
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
          Frozen view; the robot goes on.
        </span>
      )}
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
    </div>
  );
}
