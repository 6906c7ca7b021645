// The time line: the whole recording, the time cursor, the part that strip and plots show, and marks.
import { useEffect, useRef } from 'preact/hooks';
import { onFrame } from '../view/frame_clock.js';
import type { PlayedRecording } from './player_app.js';

export function Timeline({ app }: { app: PlayedRecording }) {
  const track = useRef<HTMLDivElement>(null);
  const thumb = useRef<HTMLDivElement>(null);
  const { time } = app;
  // The length is computed at each use, because a recording may grow.
  const length = () => Math.max(1, time.last - time.first);
  const percent = (tick: number) => `${Math.max(0, Math.min(100, ((tick - time.first) / length()) * 100))}%`;
  useEffect(() => {
    let last = '';
    return onFrame(() => {
      const tick = time.cursor.peek();
      const key = `${tick}/${time.last}`;
      if (key !== last && track.current !== null && thumb.current !== null) {
        last = key;
        thumb.current.style.left = percent(tick);
        track.current.setAttribute('aria-valuenow', String(tick));
        track.current.setAttribute('aria-valuetext', `${(tick / app.tickRate).toFixed(2)} seconds`);
      }
    });
  }, []);
  const seek = (event: PointerEvent) => {
    const box = (track.current as HTMLDivElement).getBoundingClientRect();
    time.pick(time.first + ((event.clientX - box.left) / Math.max(1, box.width)) * length());
  };
  const part = time.part.value;
  return (
    <div class="timeline">
      <div
        ref={track}
        class="track"
        role="slider"
        tabIndex={0}
        aria-label="Time"
        aria-valuemin={time.first}
        aria-valuemax={time.last}
        data-testid="timeline"
        onPointerDown={(event) => {
          event.currentTarget.setPointerCapture(event.pointerId);
          seek(event);
        }}
        onPointerMove={(event) => {
          if (event.buttons === 1) seek(event);
        }}
        onKeyDown={(event) => {
          // Handles the arrow keys, which the page leaves to sliders (keyboard.ts); the page has handled the other keys.
          if (!event.defaultPrevented) app.actions.forKey(event, false)?.run();
        }}
      >
        {part !== null && (
          <div class="part" style={{ left: percent(part.from), right: `calc(100% - ${percent(part.to)})` }} />
        )}
        {app.recording.marks.map((mark, i) => (
          <i key={i} class={`time-mark ${mark.kind}`} style={{ left: percent(mark.tick) }} title={mark.text} />
        ))}
        <div ref={thumb} class="thumb" />
      </div>
    </div>
  );
}
