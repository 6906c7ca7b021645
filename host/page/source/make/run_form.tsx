// How the scenario is run, and what each value costs.
import type { RunDocument } from '../wire/messages.js';
import { ChoiceField } from './fields/choice_field.js';
import type { MakeApp } from './make_app.js';
import { NumberField } from './fields/number_field.js';
import { TextField } from './fields/text_field.js';

const engineTexts: Record<RunDocument['engine'], string> = {
  ode: 'ODE: any robot, any world',
  reduced: 'reduced: chains on level ground and steps; the same bits on every computer, and twenty times as fast',
  mujoco: 'MuJoCo: a second opinion, if the program has it',
};

const solverTexts: Record<RunDocument['solver'], string> = {
  automatic: 'automatic: direct up to 8 links',
  direct: 'direct: exact, slow for long robots',
  iterative: 'iterative: fast for long robots, not exact',
};

const lengths = [
  { name: 'duration', unit: 's', title: 'How long proleg simulate runs it. The page Live has no end.' },
  { name: 'tick', unit: 'ms', title: 'How often the modules compute the gait. Shorter is smoother, and more load on the bus.' },
  { name: 'step', unit: 'ms', title: 'Of the physics. Shorter is more exact and takes longer; a tick is a whole number of steps.' },
] as const;

export function RunForm({ app }: { app: MakeApp }) {
  const run = app.draft.value?.run;
  if (run === undefined) return null;
  const isDisabled = app.obstacle() !== null;
  return (
    <div class="fields">
      <ChoiceField label="engine" value={run.engine} texts={engineTexts} isDisabled={isDisabled} commit={(value) => void app.tellRun({ name: 'engine', value })} />
      {lengths.map(({ name, unit, title }) => (
        <NumberField
          key={name}
          label={name}
          unit={unit}
          title={title}
          value={run[name]}
          isDisabled={isDisabled}
          commit={(value) => app.changeRun({ name, value })}
        />
      ))}
      <NumberField
        label="gravity"
        unit="m/s²"
        title="Downwards. Earth: 9.81, Moon: 1.62."
        value={-run.gravity[2]}
        isDisabled={isDisabled}
        commit={(value) => app.changeRun({ name: 'gravity', value: [run.gravity[0], run.gravity[1], -value] })}
      />
      <TextField
        label="seed"
        isNumeric
        size={8}
        value={run.seed}
        isDisabled={isDisabled}
        title="Another number is another world of noise; the same number repeats the run."
        commit={(value) => app.changeRun({ name: 'seed', value })}
      />
      <NumberField
        label="contact noise"
        title="How often a touch sensor is wrong: 0 never, 1 always."
        value={run.contact_noise}
        isDisabled={isDisabled}
        commit={(value) => app.changeRun({ name: 'contact_noise', value })}
      />
      <ChoiceField label="solver" value={run.solver} texts={solverTexts} isDisabled={isDisabled} commit={(value) => void app.tellRun({ name: 'solver', value })} />
      <label class="switch">
        <input
          type="checkbox"
          checked={run.self_collision}
          disabled={isDisabled}
          onChange={(event) => void app.tellRun({ name: 'self_collision', value: event.currentTarget.checked })}
          onKeyDown={(event) => {
            if (event.key === 'Enter') void app.tellRun({ name: 'self_collision', value: !run.self_collision }); // Space is STOP
          }}
        />
        links touch each other
      </label>
    </div>
  );
}

// What belongs to the scenario.
export function FileList({ app }: { app: MakeApp }) {
  const draft = app.draft.value;
  if (draft === null) return null;
  const modules = [...new Set(draft.robot.links.map(({ file }) => file))].filter((file) => file !== '' && file !== draft.robot.file);
  const files: [string, string][] = [
    ['scenario', draft.file],
    ['robot', draft.robot.file],
    ...modules.map((file): [string, string] => ['links', file]),
    ['behaviour', draft.behaviour.file],
    ['world', draft.world.file],
  ];
  return (
    <dl class="file-list">
      {files.map(([part, file]) => (
        <div key={file}>
          <dt>{part}</dt>
          <dd>
            {file}
            {draft.changed.includes(file) ? ' (changed)' : ''}
          </dd>
        </div>
      ))}
    </dl>
  );
}
