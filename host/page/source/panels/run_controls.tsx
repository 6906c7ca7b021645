// Controls to run, pause, step and restart, and for the speed; the present tick and time.
import { useSignal } from '@preact/signals';
import type { ComponentChildren } from 'preact';
import type { Stores } from '../view/robot_view.js';
import { recordOrEnd } from '../view/page_actions.js';
import { pauseIcon, recordIcon, restartIcon, runIcon, stepIcon } from './icons.js';
import { TickCounter } from './tick_counter.js';

// The slider is logarithmic: -1 is 0.1, 0 is real time, 2 is 100.
function factorOf(position: number): number {
  return Number((10 ** position).toPrecision(2));
}

function Factor({ app }: { app: Stores<'operations' | 'state'> }) {
  const factor = app.state.simulation.value?.factor ?? 1;
  const isHolder = app.state.isHolder.value;
  // While the slider is dragged, it follows the pointer, not the value of the program.
  const dragged = useSignal<number | null>(null);
  const set = (value: number) => void app.operations.tell('factor', { value });
  const position = dragged.value ?? (factor === 0 ? 2 : Math.log10(factor));
  const shown = dragged.value !== null ? factorOf(dragged.value) : factor;
  return (
    <div class="factor">
      <label for="factor">Speed</label>
      <input
        id="factor"
        type="range"
        min="-1"
        max="2"
        step="0.05"
        value={position}
        disabled={!isHolder || factor === 0}
        aria-valuetext={shown === 0 ? 'as fast as it goes' : `${shown} times real time`}
        onInput={(event) => {
          dragged.value = Number(event.currentTarget.value);
          set(factorOf(dragged.value));
        }}
        onChange={() => (dragged.value = null)}
        onDblClick={() => {
          dragged.value = null;
          set(1);
        }}
        title="Simulated seconds in a second. Double click: real time."
      />
      <output for="factor">{shown === 0 ? 'max' : `× ${shown}`}</output>
      <button
        type="button"
        aria-pressed={factor === 0}
        disabled={!isHolder}
        onClick={() => set(factor === 0 ? 1 : 0)}
        title="As fast as this computer can"
      >
        Fastest
      </button>
    </div>
  );
}

function Figure({ name, help, children }: { name: string; help: string; children: ComponentChildren }) {
  return (
    <div title={help}>
      <dt>{name}</dt>
      <dd>{children}</dd>
    </div>
  );
}

function Measures({ app }: { app: Stores<'state'> }) {
  const session = app.state.simulation.value;
  const [speed, distance] = [session?.recent_speed, session?.measures?.['distance']];
  // Both are there from the start: one that came later would move the panels below.
  return (
    <dl class="figures measures">
      <Figure name="robot speed" help="Of the centre of mass over the last two strides, in any direction">
        {typeof speed === 'number' ? `${(speed * 1000).toFixed(1)} mm/s` : '–'}
      </Figure>
      <Figure name="distance" help="Of the centre of mass from where the run began, in a straight line; without moves by hand">
        {typeof distance === 'number' ? `${distance.toFixed(3)} m` : '–'}
      </Figure>
    </dl>
  );
}

export function RunControls({ app }: { app: Stores<'newestTick' | 'operations' | 'state' | 'tickRate'> }) {
  const { state, operations } = app;
  const isHolder = state.isHolder.value;
  const runState = state.simulation.value?.state ?? 'paused';
  const isRunning = runState === 'running';
  const recording = state.session.value?.recording ?? null;
  const ticks = useSignal(1);
  const typedTicks = useSignal<string | null>(null);
  return (
    <section class="run-controls" aria-label="Run">
      <button
        type="button"
        class="primary run"
        disabled={!isHolder || runState === 'failed'}
        onClick={() => void operations.tell(isRunning ? 'pause' : 'run', {})}
        title="Run, or pause (K). Esc pauses, too"
      >
        {isRunning ? pauseIcon : runIcon} {isRunning ? 'Pause' : 'Run'}
      </button>
      <span class="joined">
        <button
          type="button"
          disabled={!isHolder || runState === 'failed'}
          onClick={() => void operations.tell('step', { ticks: ticks.value })}
          title="Some ticks, then pause (.)"
        >
          {stepIcon} Step
        </button>
        <input
          type="number"
          min="1"
          max="1000"
          aria-label="Ticks of a step"
          title="Ticks of a step: 1 to 1000"
          value={typedTicks.value ?? ticks.value}
          disabled={!isHolder}
          onInput={(event) => (typedTicks.value = event.currentTarget.value)}
          onChange={(event) => {
            ticks.value = Math.max(1, Math.min(1000, Math.round(Number(event.currentTarget.value)) || 1));
            typedTicks.value = null;
          }}
        />
      </span>
      <button
        type="button"
        disabled={!isHolder}
        onClick={() => void operations.tell('restart', {})}
        title="Back to tick 0, with the parameters as they are now (Shift + R)"
      >
        {restartIcon} Restart
      </button>
      <button
        type="button"
        disabled={!isHolder || runState === 'failed'}
        class="record"
        aria-pressed={recording !== null}
        onClick={() => recordOrEnd(app)}
        title={recording === null ? 'Records the whole run, from tick 0 on (R)' : `Ends the recording ${recording} (R)`}
      >
        {recordIcon} {recording === null ? 'Record' : 'Recording'}
      </button>
      <Factor app={app} />
      <TickCounter app={app} />
      <Measures app={app} />
      {state.isLookingOn.value && <span class="hint">You look on. Take control to change anything.</span>}
      {isHolder && runState === 'stopped' && <span class="hint">Stopped. Run goes on from here.</span>}
    </section>
  );
}
