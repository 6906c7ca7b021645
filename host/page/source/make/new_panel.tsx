// New: a robot, its gait and its world in four steps. Each choice makes the draft anew, so that the drawings, the 3D view
// and the next half minute show it at once. Nothing is on disk before the last step.
import { signal } from '@preact/signals-core';
import { useEffect } from 'preact/hooks';
import type { NewScenario, RobotKind } from '../wire/messages.js';
import type { MakeApp } from './make_app.js';
import { algorithmTitle } from '../state/robot_text.js';

const steps = ['robot', 'gait', 'world', 'name'] as const;

interface Choice {
  value: string;
  title: string;
  text: string;
}

// Gaits that suit a robot, in plain words; the others are in the part Behaviour.
const usualGait: Choice = { value: '', title: 'the usual one', text: 'A wave that runs along the robot: it crawls.' };

const worlds: readonly (Choice & { values?: Record<string, number>; friction?: number })[] = [
  { value: '', title: 'flat', text: 'A level floor without end.' },
  { value: 'box', title: 'a step', text: 'A step of 2 cm.', values: { height: 0.02 } },
  { value: 'stairs', title: 'stairs', text: 'Three steps up.' },
  { value: 'ramp', title: 'a ramp', text: 'A slope up.' },
  { value: 'hills', title: 'hills', text: 'Waves in the ground, as the obstacle of the thesis.' },
  { value: 'rough ground', title: 'rough ground', text: 'Small heights, different everywhere.' },
];

const friction = [
  { value: '', title: 'usual', text: 'As the shipped floor.' },
  { value: '0.05', title: 'slippery', text: 'As ice.' },
  { value: '0.5', title: 'grippy', text: 'As a carpet.' },
];

// What has been chosen; it stays while the panel is closed.
class Choices {
  readonly kind = signal('');
  readonly axes = signal<string | null>(null); // null: those of the kind
  readonly algorithm = signal('');
  readonly world = signal('');
  readonly friction = signal('');
  readonly name = signal('');
  readonly problem = signal<string | null>(null);

  get words(): NewScenario {
    const world = worlds.find(({ value }) => value === this.world.peek());
    return {
      ...(this.kind.peek() === '' ? {} : { kind: this.kind.peek() }),
      ...(this.axes.peek() === null ? {} : { axes: this.axes.peek() as string }),
      ...(this.algorithm.peek() === '' ? {} : { algorithm: this.algorithm.peek() }),
      ...(world === undefined || world.value === '' ? {} : { item: world.value, ...(world.values === undefined ? {} : { values: world.values }) }),
      ...(this.friction.peek() === '' ? {} : { friction: Number(this.friction.peek()) }),
    };
  }
}

const choices = new Choices();

function Choose({ name, label, value, all, set }: { name: string; label: string; value: string; all: readonly Choice[]; set(value: string): void }) {
  return (
    <fieldset class="choose">
      <legend>{label}</legend>
      {all.map((choice) => (
        <label key={choice.value} class={choice.value === value ? 'chosen' : ''}>
          <input type="radio" name={name} value={choice.value} checked={choice.value === value} onChange={() => set(choice.value)} />
          <span>
            <strong>{choice.title}</strong> {choice.text}
          </span>
        </label>
      ))}
    </fieldset>
  );
}

// The axes of a new robot of a kind as letters, from the tail.
function axesOf({ axes, joints }: RobotKind): string {
  return axes.repeat(Math.ceil(joints / axes.length)).slice(0, joints);
}

function RobotStep({ app, send }: { app: MakeApp; send(): void }) {
  const kinds = app.page.state.parts.value?.kinds ?? [];
  const most = app.page.state.parts.value?.most_joints ?? 64;
  const kind = kinds.find(({ name }) => name === choices.kind.value) ?? kinds[0];
  const axes = choices.axes.value ?? (kind === undefined ? '' : axesOf(kind));
  const setAxes = (next: string) => {
    choices.axes.value = next;
    send();
  };
  return (
    <>
      <Choose
        name="kind"
        label="Which robot?"
        value={kind?.name ?? ''}
        all={kinds.map((each) => ({ value: each.name, title: each.name, text: each.help }))}
        set={(value) => {
          choices.kind.value = value;
          choices.axes.value = null;
          send();
        }}
      />
      <fieldset class="choose">
        <legend>How many joints?</legend>
        <div class="fields">
          <button type="button" aria-label="a joint less" disabled={axes.length <= 1} onClick={() => setAxes(axes.slice(0, -1))}>
            −
          </button>
          <output data-testid="new-joints">{axes.length}</output>
          <button type="button" aria-label="a joint more" disabled={axes.length >= most} onClick={() => setAxes(axes + (axes.at(-2) ?? axes.at(-1) ?? 'p'))}>
            +
          </button>
          <span class="hint">from the tail; press a letter: p bends up and down, y to the sides</span>
        </div>
        <div class="fields axes">
          {[...axes].map((letter, i) => (
            <button
              key={i}
              type="button"
              aria-label={`joint ${i + 1}: ${letter === 'p' ? 'pitch' : 'yaw'}`}
              onClick={() => setAxes(axes.slice(0, i) + (letter === 'p' ? 'y' : 'p') + axes.slice(i + 1))}
            >
              {letter}
            </button>
          ))}
        </div>
      </fieldset>
    </>
  );
}

function GaitStep({ app, send }: { app: MakeApp; send(): void }) {
  const algorithms = app.page.state.algorithms.value;
  return (
    <Choose
      name="algorithm"
      label="How does it move?"
      value={choices.algorithm.value}
      all={[usualGait, ...algorithms.map(({ name, help }) => ({ value: name, title: algorithmTitle(name), text: help }))]}
      set={(value) => {
        choices.algorithm.value = value;
        send();
      }}
    />
  );
}

function WorldStep({ send }: { send(): void }) {
  return (
    <>
      <Choose
        name="world"
        label="What is in its way?"
        value={choices.world.value}
        all={worlds}
        set={(value) => {
          choices.world.value = value;
          send();
        }}
      />
      <Choose
        name="friction"
        label="How is the ground?"
        value={choices.friction.value}
        all={friction}
        set={(value) => {
          choices.friction.value = value;
          send();
        }}
      />
    </>
  );
}

// Before a draft that has no files is replaced.
export function LossQuestion({ app }: { app: MakeApp }) {
  return (
    <section class="panel make-panel" aria-label="Unsaved" data-testid="loss-question">
      <p>The changes of the present scenario are not saved, and it has no files in which they could be kept.</p>
      <div class="fields">
        <button type="button" class="primary" onClick={() => (app.panel.value = 'save')}>
          Save …
        </button>
        <button type="button" onClick={() => (app.discards.value = true)}>
          Go on without them
        </button>
        <button type="button" onClick={() => (app.panel.value = 'none')}>
          Close
        </button>
      </div>
    </section>
  );
}

export function NewPanel({ app }: { app: MakeApp }) {
  const obstacle = app.obstacle();
  const step = app.newStep.value;
  const last = steps.length - 1;
  const wouldLose = app.wouldLose();
  const send = () => {
    app.makeNew(choices.words, (refusal) => (choices.problem.value = refusal));
  };
  useEffect(() => {
    if (obstacle === null && !wouldLose) send();
  }, [obstacle, wouldLose]);
  if (wouldLose) return <LossQuestion app={app} />;
  const name = choices.name.value.trim();
  const create = async () => {
    const folder = name === '' ? `robot ${new Date().toISOString().slice(0, 10)}` : name;
    const refusal = await app.createNew({ ...choices.words, name: folder }, folder);
    choices.problem.value = refusal;
    if (refusal === null) choices.name.value = '';
  };
  return (
    <section class="panel make-panel new-panel" aria-label="New" data-testid="new-panel">
      <ol class="steps">
        {steps.map((each, i) => (
          <li key={each}>
            <button type="button" aria-current={i === step ? 'step' : undefined} onClick={() => (app.newStep.value = i)}>
              {i + 1}. {each}
            </button>
          </li>
        ))}
      </ol>
      {obstacle !== null && <p class="hint">{obstacle}</p>}
      <form
        onSubmit={(event) => {
          event.preventDefault();
          if (step < last) app.newStep.value = step + 1;
          else void create();
        }}
      >
        {step === 0 && <RobotStep app={app} send={send} />}
        {step === 1 && <GaitStep app={app} send={send} />}
        {step === 2 && <WorldStep send={send} />}
        {step === 3 && (
          <fieldset class="choose">
            <legend>What is its name?</legend>
            <label>
              <input
                type="text"
                name="name"
                aria-label="name of the robot and of its folder"
                autocomplete="off"
                size={32}
                placeholder="its name, and that of its folder"
                value={choices.name}
                onInput={(event) => (choices.name.value = event.currentTarget.value)}
              />
            </label>
            <p class="hint">The files are written into a new folder with this name; then the robot crawls on the page Live.</p>
          </fieldset>
        )}
        {choices.problem.value !== null && (
          <p class="problem" role="alert">
            {choices.problem.value}
          </p>
        )}
        <div class="fields">
          <button type="button" disabled={step === 0} onClick={() => (app.newStep.value = step - 1)}>
            Back
          </button>
          <button type="submit" class="primary" disabled={obstacle !== null}>
            {step < last ? 'Next' : 'Create and start'}
          </button>
          <button type="button" onClick={() => (app.panel.value = 'none')}>
            Close
          </button>
        </div>
      </form>
    </section>
  );
}
