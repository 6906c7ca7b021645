// Plays the draft and the candidate beside it, round and round.
import { useEffect, useRef } from 'preact/hooks';
import { pauseIcon, runIcon } from '../../panels/icons.js';
import { onFrame } from '../../view/frame_clock.js';
import type { MotionPair } from './motion.js';
import type { SearchApp } from './search_app.js';

const textPeriod = 100; // milliseconds

function Controls({ motion }: { motion: MotionPair }) {
  const slider = useRef<HTMLInputElement>(null);
  const text = useRef<HTMLSpanElement>(null);
  const isPlaying = motion.time.isPlaying.value;
  useEffect(() => {
    let last = 0;
    return onFrame((now) => {
      if (now - last < textPeriod || slider.current === null || text.current === null) return;
      last = now;
      const shown = motion.seconds.toFixed(1);
      if (text.current.textContent === `${shown} s`) return;
      text.current.textContent = `${shown} s`;
      slider.current.value = shown;
      slider.current.setAttribute('aria-valuetext', `${shown} seconds`);
    });
  }, [motion]);
  return (
    <>
      <button type="button" onClick={() => (motion.time.isPlaying.value = !isPlaying)}>
        {isPlaying ? pauseIcon : runIcon} {isPlaying ? 'Pause' : 'Play'}
      </button>
      <input
        ref={slider}
        type="range"
        class="motion-time"
        min={0}
        max={motion.duration}
        step={0.1}
        aria-label="Time of the motion"
        onInput={(event) => {
          motion.time.isPlaying.value = false;
          motion.seekSeconds(Number(event.currentTarget.value));
        }}
      />
      <span class="hint" ref={text} data-testid="motion-time" />
    </>
  );
}

// what: that moves beside the present gait; null: nothing is chosen.
export function MotionControls({ app, what, hint }: { app: SearchApp; what: string | null; hint: string }) {
  const motion = app.host.motion.value;
  const problem = app.motions.problem.value;
  if (what === null) return <p class="hint">{hint}</p>;
  return (
    <div class="fields" role="group" aria-label="Motion" data-testid="motion">
      {problem !== null ? (
        <p class="problem" role="alert">
          {problem}
        </p>
      ) : motion === null ? (
        <p class="hint">Computing the motion …</p>
      ) : (
        <>
          <Controls motion={motion} />
          <span class="hint">
            The present gait, and <i class="mark ghost" /> {what} translucent{app.motions.isWaiting.value ? ' (computing …)' : ''}
          </span>
        </>
      )}
    </div>
  );
}
