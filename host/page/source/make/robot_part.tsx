// The robot as a chain of joints and links, and the numbers of what is chosen.
import { openDialog } from '../view/dialogs.js';
import type { DraftRobot } from '../wire/messages.js';
import { ChainTable } from './chain_table.js';
import { JointForm, LinkForm } from './joint_form.js';
import { JointTableDialog } from './joint_table_dialog.js';
import type { MakeApp } from './make_app.js';
import { ModuleMeshForm } from './mesh_form.js';
import { formatNumber } from '../state/parameter_values.js';
import { NumberField } from './fields/number_field.js';
import { SensorPanel } from './sensor_panel.js';
import { TextField } from './fields/text_field.js';

const servoFields = [
  { name: 'gain', unit: '1/s', title: 'How hard the servo pulls towards its angle. A larger one follows more closely.' },
  { name: 'period', unit: 'ms', title: 'How often the servo gets a new angle.' },
  { name: 'command_speed', unit: '°/s', title: 'How fast a commanded angle changes at most.' },
  { name: 'latency', unit: 'ms', title: 'How late the servo acts on a new angle.' },
] as const;

// What a person does with the chosen joint as a whole.
function ChainTools({ app, robot }: { app: MakeApp; robot: DraftRobot }) {
  const count = robot.joints.length;
  const chosen = app.chosenJoints.value.filter((joint) => joint < count);
  const joint = chosen[0];
  const obstacle = app.obstacle() ?? (robot.obstacle === null ? null : `Links cannot be added here: ${robot.obstacle}`);
  const isDisabled = obstacle !== null || joint === undefined;
  const why = obstacle ?? (joint === undefined ? 'Choose a joint first.' : undefined);
  const all = Array.from({ length: count }, (_, i) => i);
  return (
    <>
      <div class="fields">
        <NumberField
          label="joints"
          decimals={0}
          value={count}
          isDisabled={obstacle !== null}
          title={obstacle ?? 'New ones come at the head. Axes that alternate go on so.'}
          commit={(value) => (Number.isInteger(value) && value > 0 ? app.changes.change('robot.count', { value }) : `found ${value}, expected a whole number above 0`)}
        />
        <button type="button" disabled={isDisabled} title={why ?? 'Adds a copy of the chosen joint and its link'} onClick={() => void app.changes.tell('robot.duplicate', { joint: joint! })}>
          Add a copy
        </button>
        <button type="button" disabled={isDisabled || count < 2} title={why ?? 'Undo brings it back (Delete)'} onClick={() => void app.removeJoint()}>
          Delete
        </button>
        <button type="button" disabled={isDisabled || joint === count - 1} title={why ?? 'Exchanges it, with its link, with the joint behind it'} onClick={() => void app.moveJoint(joint!, joint! + 1)}>
          ← to the tail
        </button>
        <button type="button" disabled={isDisabled || joint === 0} title={why ?? 'Exchanges it, with its link, with the joint in front of it'} onClick={() => void app.moveJoint(joint!, joint! - 1)}>
          to the head →
        </button>
        <button
          type="button"
          disabled={obstacle !== null || count < 2}
          title={obstacle ?? 'The last joint becomes the first one'}
          onClick={() => void app.changes.tell('robot.order', { order: [...all].reverse() })}
        >
          Reverse
        </button>
        <button type="button" title="Values of several joints can be set at once" onClick={() => (app.chosenJoints.value = chosen.length === count ? [] : all)}>
          {chosen.length === count ? 'Choose none' : 'Choose all'}
        </button>
        <button type="button" title="All values of all joints, to copy from and to paste into (T)" onClick={() => (openDialog.value = 'joint_table')}>
          Table …
        </button>
      </div>
      {robot.obstacle !== null && <p class="hint">Links cannot be added or removed here: {robot.obstacle}</p>}
    </>
  );
}

function KindButtons({ app, link }: { app: MakeApp; link: number | null }) {
  const own = app.draft.value?.robot.kinds ?? [];
  const kinds = [
    ...(app.page.state.parts.value?.kinds ?? []),
    ...own.map(({ name, length }) => ({ name, help: `A module of your own, ${formatNumber(length, 5)} m from joint to joint.` })),
  ];
  const obstacle = app.obstacle();
  return (
    <div class="fields" role="group" aria-label={link === null ? 'Modules of the robot' : 'Module of the link'}>
      {kinds.map(({ name, help }) => (
        <button key={name} type="button" disabled={obstacle !== null} title={obstacle ?? help} onClick={() => void app.changes.tell('robot.kind', { kind: name, link })}>
          {name}
        </button>
      ))}
    </div>
  );
}

export function RobotPart({ app }: { app: MakeApp }) {
  const robot = app.draft.value?.robot;
  if (robot === undefined) return null;
  const isDisabled = app.obstacle() !== null;
  const joint = app.chosenJoints.value.find((chosen) => chosen < robot.joints.length);
  const isMesh = app.mesh.isOpen.value && app.mesh.purpose.value === 'module';
  return (
    <>
      <section class="panel make-panel" aria-label="Chain">
        <h2>Chain</h2>
        <TextField label="name" value={robot.name} isDisabled={isDisabled} commit={(name) => app.changes.change('robot.rename', { name })} />
        <ChainTable app={app} robot={robot} />
        <ChainTools app={app} robot={robot} />
      </section>
      <section class="panel make-panel" aria-label="Chosen joints">
        <h2>{joint === undefined ? 'Joint' : app.chosenJoints.value.length > 1 ? `${app.chosenJoints.value.length} joints` : robot.joints[joint]!.name}</h2>
        <JointForm app={app} robot={robot} />
      </section>
      {joint !== undefined && app.chosenJoints.value.length === 1 && (
        <section class="panel make-panel" aria-label="Link">
          <h2>The link in front of it: {robot.links[joint]!.name}</h2>
          <LinkForm app={app} robot={robot} link={joint} />
          <p class="hint">Another module for this link:</p>
          <KindButtons app={app} link={joint} />
        </section>
      )}
      {openDialog.value === 'joint_table' && <JointTableDialog app={app} robot={robot} />}
      <SensorPanel app={app} robot={robot} />
      <section class="panel make-panel" aria-label="Modules and servos">
        <h2>Modules</h2>
        <p class="hint">Of which modules the robot is made. Joints keep their axes, servos and gait.</p>
        <KindButtons app={app} link={null} />
        <div class="fields">
          <button
            type="button"
            aria-pressed={isMesh}
            disabled={isDisabled}
            title={app.obstacle() ?? 'A shape of your own, from a file'}
            onClick={() => (isMesh ? app.mesh.close() : app.mesh.open('module'))}
          >
            Module of my own …
          </button>
        </div>
        {isMesh && <ModuleMeshForm app={app} />}
        <h2>Servos</h2>
        <div class="fields">
          {servoFields.map(({ name, unit, title }) => (
            <NumberField
              key={name}
              label={name.replace('_', ' ')}
              unit={unit}
              title={title}
              value={robot.servo[name]}
              isDisabled={isDisabled}
              commit={(value) => app.changes.change('robot.servo', { name, value })}
            />
          ))}
        </div>
      </section>
    </>
  );
}
