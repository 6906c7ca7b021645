// The present tick and time.
import { useEffect, useRef } from 'preact/hooks';
import { onFrame } from '../view/frame_clock.js';
import type { Stores } from '../view/robot_view.js';

export function TickCounter({ app }: { app: Stores<'newestTick' | 'tickRate'> }) {
  const tick = useRef<HTMLElement>(null);
  const time = useRef<HTMLElement>(null);
  useEffect(
    () =>
      onFrame(() => {
        const newest = app.newestTick;
        const text = String(newest);
        if (tick.current !== null && time.current !== null && tick.current.textContent !== text) {
          tick.current.textContent = text;
          time.current.textContent = `${(newest / app.tickRate).toFixed(2)} s`;
        }
      }),
    [],
  );
  return (
    <dl class="figures">
      <div>
        <dt>tick</dt>
        <dd ref={tick} data-testid="tick">
          0
        </dd>
      </div>
      <div>
        <dt>time</dt>
        <dd ref={time} data-testid="time">
          0.00 s
        </dd>
      </div>
    </dl>
  );
}
