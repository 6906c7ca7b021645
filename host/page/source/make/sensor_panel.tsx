// The sensors that the robot carries.
import { useSignal } from '@preact/signals';
import type { DraftRobot, DraftSensor, PartsDocument } from '../wire/messages.js';
import { ChoiceField } from './fields/choice_field.js';
import type { MakeApp } from './make_app.js';
import { NumberField } from './fields/number_field.js';
import { TextField } from './fields/text_field.js';

type SensorNumber = 'minangle' | 'maxangle' | 'resolution' | 'maxrange' | 'scantime';

const laserFields: readonly { name: SensorNumber; label: string; unit: string }[] = [
  { name: 'minangle', label: 'from', unit: '°' },
  { name: 'maxangle', label: 'to', unit: '°' },
  { name: 'resolution', label: 'between two rays', unit: '°' },
  { name: 'maxrange', label: 'range', unit: 'm' },
  { name: 'scantime', label: 'time of a scan', unit: 's' },
];

const inputTexts = { none: 'recorded only', front: 'instead of the front touch sensor', rear: 'instead of the rear touch sensor' };

function AddForm({ app, robot, parts }: { app: MakeApp; robot: DraftRobot; parts: PartsDocument }) {
  const kind = useSignal(parts.sensors[0]?.kind ?? '');
  const part = useSignal(0);
  const place = useSignal(parts.places[0] ?? '');
  const chosen = parts.sensors.find((sensor) => sensor.kind === kind.value);
  const obstacle = app.obstacle();
  const names = chosen?.at_joint === true ? robot.joints : robot.links;
  const hasPlace = /Tactile|Laser/.test(kind.value);
  return (
    <form
      class="fields"
      aria-label="New sensor"
      onSubmit={(event) => {
        event.preventDefault();
        void app.changes.tell('robot.add_sensor', { kind: kind.value, part: Math.min(part.value, names.length - 1), place: place.value });
      }}
    >
      <ChoiceField
        label="new"
        value={kind.value}
        texts={Object.fromEntries(parts.sensors.map((sensor) => [sensor.kind, `${sensor.kind}: ${sensor.help}`]))}
        isDisabled={obstacle !== null}
        commit={(value) => (kind.value = value)}
      />
      <ChoiceField
        label="at"
        value={String(Math.min(part.value, names.length - 1))}
        texts={Object.fromEntries(names.map(({ name }, i) => [String(i), name]))}
        isDisabled={obstacle !== null}
        commit={(value) => (part.value = Number(value))}
      />
      {hasPlace && (
        <ChoiceField
          label="side"
          value={place.value}
          texts={Object.fromEntries(parts.places.map((name) => [name, name]))}
          isDisabled={obstacle !== null}
          commit={(value) => (place.value = value)}
        />
      )}
      <button type="submit" disabled={obstacle !== null} title={obstacle ?? chosen?.help}>
        Add sensor
      </button>
    </form>
  );
}

function SensorForm({ app, sensor, number }: { app: MakeApp; sensor: DraftSensor; number: number }) {
  const isDisabled = app.obstacle() !== null;
  const set = (name: string, value: string) => app.changes.change('robot.set_sensor', { sensor: number, name, value });
  const isPlaced = sensor.kind !== 'ServoCurrent';
  return (
    <div class="object-form">
      <TextField label="name" value={sensor.name} isDisabled={isDisabled} commit={(name) => app.changes.change('robot.rename_sensor', { sensor: number, name })} />
      {isPlaced && (
        <div class="fields">
          {(['x', 'y', 'z'] as const).map((axis, i) => (
            <NumberField
              key={axis}
              label={axis}
              unit="m"
              title={['to the right', 'towards the head', 'up'][i] as string}
              value={sensor.pose[i] as number}
              isDisabled={isDisabled}
              commit={(value) =>
                app.changes.changeOf('robot.place_sensor', ({ robot }) => {
                  const pose = (robot.sensors[number] ?? sensor).pose.map((old, at) => (at === i ? value : old));
                  return { sensor: number, pose: pose as unknown as typeof sensor.pose };
                })
              }
            />
          ))}
        </div>
      )}
      {sensor.kind === 'TactileSensor' && (
        <div class="fields">
          {sensor.extents != null &&
            (['x', 'y', 'z'] as const).map((axis, i) => (
              <NumberField
                key={axis}
                label={`size ${axis}`}
                unit="m"
                value={2 * sensor.extents![i]!}
                isDisabled={isDisabled}
                commit={(value) =>
                  app.changes.changeOf('robot.set_sensor', ({ robot }) => {
                    const halves = robot.sensors[number]?.extents ?? sensor.extents!;
                    return { sensor: number, name: 'extents', value: halves.map((half, at) => (at === i ? value / 2 : half)).join(' ') };
                  })
                }
              />
            ))}
          <ChoiceField
            label="the gait feels it"
            value={sensor.input ?? 'none'}
            texts={inputTexts}
            isDisabled={isDisabled}
            title="A module has two inputs for touch. Reflexes react to what is wired to them."
            commit={(value) => void app.changes.tell('robot.set_sensor', { sensor: number, name: 'input', value: value === 'none' ? '' : value })}
          />
        </div>
      )}
      {sensor.kind === 'BaseLaser2D' && (
        <div class="fields">
          {laserFields.map(({ name, label, unit }) => (
            <NumberField key={name} label={label} unit={unit} value={sensor[name] ?? 0} isDisabled={isDisabled} commit={(value) => set(name, String(value))} />
          ))}
        </div>
      )}
      <button type="button" disabled={isDisabled} title="Undo brings it back" onClick={() => void app.changes.tell('robot.remove_sensor', { sensor: number })}>
        Delete {sensor.name}
      </button>
    </div>
  );
}

export function SensorPanel({ app, robot }: { app: MakeApp; robot: DraftRobot }) {
  const chosen = useSignal<number | null>(null);
  const parts = app.page.state.parts.value;
  const sensor = chosen.value === null ? undefined : robot.sensors[chosen.value];
  return (
    <section class="panel make-panel" aria-label="Sensors">
      <h2>Sensors</h2>
      <p class="hint">Each link has two touch sensors under it. These come in addition:</p>
      <ul class="objects">
        {robot.sensors.map(({ name, kind, part_name }, i) => (
          <li key={name}>
            <button type="button" aria-pressed={chosen.value === i} onClick={() => (chosen.value = chosen.value === i ? null : i)}>
              {name}
            </button>
            <span class="hint">
              {kind} at {part_name}
            </span>
          </li>
        ))}
      </ul>
      {sensor !== undefined && <SensorForm key={`${chosen.value} ${sensor.kind}`} app={app} sensor={sensor} number={chosen.value!} />}
      {parts !== null && <AddForm app={app} robot={robot} parts={parts} />}
    </section>
  );
}
