// Positions of joints: a slider and a number for each, at a limited speed. It is possible only while the robot is held.
import { useSignal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import { onFrame } from '../../view/frame_clock.js';
import type { Stores } from '../../view/robot_view.js';
import { poseZero } from '../../view/robot_actions.js';
import { fastest, slowest } from '../../state/pose_queue.js';
import { parseNumber } from '../../state/parameter_values.js';
import type { Joint } from '../../wire/messages.js';
import { numberText, positionOf, valueOf } from '../joint_values.js';
import { CommandButton } from './command_button.js';

const readoutPeriod = 100; // milliseconds

// Reads a number within limits; returns a text that says what is wrong otherwise.
function parseWithin(text: string, low: number, high: number): number | string {
  const value = parseNumber(text);
  return typeof value === 'number' && (value < low || value > high) ? `found ${text.trim()}, expected ${low} to ${high}` : value;
}

function PoseRow({ app, joint, index, isPossible }: { app: Stores<'history' | 'poses' | 'rowsAtCursor' | 'selection' | 'state'>; joint: Joint; index: number; isPossible: boolean }) {
  const slider = useRef<HTMLInputElement>(null);
  const number = useRef<HTMLInputElement>(null);
  const mark = useRef<HTMLElement>(null);
  const problem = useSignal<string | null>(null);
  const joints = app.state.robot.value?.joints.length ?? 0;
  const { lower, upper, name } = joint;
  const move = (angle: number) => app.poses.move(new Map([[index, angle]]), joints);
  const accept = (text: string) => {
    const value = parseWithin(text, lower, upper);
    problem.value = typeof value === 'string' ? value : null;
    if (typeof value === 'number') move(value);
  };
  // The texts are written without Preact, like all that follow telemetry. A field that the user holds or edits is not
  // changed.
  useEffect(() => {
    let last = 0;
    return onFrame((now) => {
      if (now - last < readoutPeriod || slider.current === null || number.current === null || mark.current === null) {
        return;
      }
      last = now;
      const position = positionOf(app, index);
      if (position !== null && !slider.current.matches(':active')) slider.current.value = String(position);
      if (document.activeElement !== number.current && problem.peek() === null) {
        number.current.value = numberText(position, 1);
      }
      slider.current.setAttribute('aria-valuetext', `${numberText(position, 1)} degrees`);
      const angle = valueOf(app, 'angle', index, app.history.end - 1);
      mark.current.hidden = angle === null;
      const share = Math.max(0, Math.min(1, ((angle ?? 0) - lower) / (upper - lower || 1)));
      mark.current.style.left = `${100 * share}%`;
    });
  }, [lower, upper, index]);
  return (
    <div
      class={`pose-row ${app.selection.hoveredJoint.value === index ? 'hovered' : ''}`}
      data-pose={index}
      onPointerEnter={() => (app.selection.hoveredJoint.value = index)}
      onPointerLeave={() => (app.selection.hoveredJoint.value = null)}
    >
      <span class="pose-name">{name}</span>
      <span class="pose-slider">
        <input
          ref={slider}
          type="range"
          min={lower}
          max={upper}
          step="0.5"
          disabled={!isPossible}
          aria-label={`Position of ${name}`}
          title={`${lower} to ${upper} degrees. The mark below is the measured angle.`}
          onInput={(event) => move(Number(event.currentTarget.value))}
        />
        <i ref={mark} class="measured-mark" hidden />
      </span>
      <input
        ref={number}
        type="text"
        inputMode="decimal"
        disabled={!isPossible}
        aria-label={`Position of ${name} in degrees`}
        aria-invalid={problem.value !== null}
        onChange={(event) => accept(event.currentTarget.value)}
      />
      <span class="unit">°</span>
      {problem.value !== null && (
        <p class="problem" role="alert">
          {name}: {problem.value} degrees
        </p>
      )}
    </div>
  );
}

function Speed({ app, isPossible }: { app: Stores<'poses'>; isPossible: boolean }) {
  const { speed } = app.poses;
  return (
    <label class="pose-speed">
      Speed
      <input
        type="range"
        min={slowest}
        max={fastest}
        step="1"
        value={speed}
        disabled={!isPossible}
        aria-valuetext={`${speed.value} degrees a second`}
        onInput={(event) => (speed.value = Number(event.currentTarget.value))}
      />
      <output>{speed.value} °/s</output>
    </label>
  );
}

export function PosePanel({ app }: { app: Stores<'history' | 'poses' | 'rowsAtCursor' | 'selection' | 'state'> }) {
  const obstacle = app.state.obstacleTo('pose');
  const joints = app.state.robot.value?.joints ?? [];
  return (
    <section class="panel pose-panel" aria-label="Positions">
      <div class="pose-head">
        <h2>Positions</h2>
        <Speed app={app} isPossible={obstacle === null} />
        <CommandButton app={app} command="pose" run={() => poseZero(app)} title="All joints to 0 degrees, at this speed">
          All to 0
        </CommandButton>
      </div>
      <p class="hint" data-testid="pose-hint">
        {obstacle ?? 'Drag a slider, type a number, or drag a link in the 3D view.'}
      </p>
      <div class="pose-rows" tabIndex={0} role="group" aria-label="Positions of joints">
        {joints.map((joint, index) => (
          <PoseRow key={joint.name} app={app} joint={joint} index={index} isPossible={obstacle === null} />
        ))}
      </div>
    </section>
  );
}
