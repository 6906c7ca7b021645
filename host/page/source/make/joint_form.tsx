// The numbers of the chosen joints, and of a link.
import type { DraftJoint, DraftRobot } from '../wire/messages.js';
import { axisAngle, axisOfAngle } from '../state/robot_text.js';
import type { MakeApp } from './make_app.js';
import { NumberField } from './fields/number_field.js';
import { TextField } from './fields/text_field.js';

export function JointForm({ app, robot }: { app: MakeApp; robot: DraftRobot }) {
  const joints = app.chosenJoints.value.filter((joint) => joint < robot.joints.length);
  const first = robot.joints[joints[0] ?? -1];
  if (first === undefined) {
    return <p class="hint">Choose a joint in the table to see and change its numbers; with Shift several of them.</p>;
  }
  if (!first.editable) {
    return <p class="hint">{first.name} is in a file of its own, which other robots may use, too. It can be changed there.</p>;
  }
  const isDisabled = app.obstacle() !== null;
  const differs = (value: (joint: DraftJoint) => number | null) => joints.some((joint) => value(robot.joints[joint]!) !== value(first));
  const several = (value: (joint: DraftJoint) => number | null) => (differs(value) ? ' (they differ)' : '');
  const limit = (limits: (old: DraftJoint['limits']) => { lower: number; upper: number }) =>
    app.changes.changeOf('robot.limits', ({ robot: now }) => ({ joints, ...limits((now.joints[joints[0]!] ?? first).limits) }));
  const angle = axisAngle(first.axis);
  return (
    <div class="object-form" key={joints.join()}>
      {joints.length === 1 && (
        <TextField label="name" value={first.name} isDisabled={isDisabled} commit={(name) => app.changes.change('robot.rename_joint', { joint: joints[0]!, name })} />
      )}
      <div class="fields">
        <button type="button" disabled={isDisabled} aria-pressed={angle === 0} title="It bends up and down." onClick={() => void app.changes.tell('robot.axis', { joints, value: axisOfAngle(0) })}>
          pitch
        </button>
        <button type="button" disabled={isDisabled} aria-pressed={angle === 90} title="It bends to the sides." onClick={() => void app.changes.tell('robot.axis', { joints, value: axisOfAngle(90) })}>
          yaw
        </button>
        <NumberField
          label={`axis${several((joint) => axisAngle(joint.axis))}`}
          unit="°"
          decimals={2}
          value={angle ?? 0}
          isDisabled={isDisabled}
          title="0 is pitch, 90 is yaw; between them the joint bends askew"
          commit={(value) => app.changes.change('robot.axis', { joints, value: axisOfAngle(value) })}
        />
      </div>
      {angle === null && <p class="hint">The axis in the file, {first.axis.join(' ')}, is not across the robot.</p>}
      <div class="fields">
        <NumberField
          label={`lowest angle${several((joint) => joint.limits[0])}`}
          unit="°"
          decimals={3}
          value={first.limits[0]}
          isDisabled={isDisabled}
          title="Where the joint stops. A gait stays within ±90°."
          commit={(lower) => limit((old) => ({ lower, upper: old[1] }))}
        />
        <NumberField
          label={`highest angle${several((joint) => joint.limits[1])}`}
          unit="°"
          decimals={3}
          value={first.limits[1]}
          isDisabled={isDisabled}
          title="Where the joint stops. A gait stays within ±90°."
          commit={(upper) => limit((old) => ({ lower: old[0], upper }))}
        />
        <NumberField
          label={`torque${several((joint) => joint.torque)}`}
          unit="Nm"
          value={first.torque}
          isDisabled={isDisabled}
          title="How strong the servo is."
          commit={(value) => app.changes.change('robot.torque', { joints, value })}
        />
        <NumberField
          label={`speed${several((joint) => joint.speed)}`}
          unit="rad/s"
          value={first.speed}
          isDisabled={isDisabled}
          title="How fast the servo turns at most."
          commit={(value) => app.changes.change('robot.speed', { joints, value })}
        />
      </div>
    </div>
  );
}

export function LinkForm({ app, robot, link: number }: { app: MakeApp; robot: DraftRobot; link: number }) {
  const link = robot.links[number]!;
  const isDisabled = app.obstacle() !== null;
  return (
    <>
      <div class="fields">
        <NumberField label="mass" unit="kg" value={link.mass} isDisabled={isDisabled} commit={(value) => app.changes.change('robot.mass', { link: number, value })} />
        <NumberField
          label="friction"
          value={link.friction ?? 0}
          isDisabled={isDisabled}
          title="How well it grips: 0 is ice, 1 is rubber."
          commit={(value) => app.changes.change('robot.friction', { link: number, value })}
        />
      </div>
      {link.friction === null && <p class="hint">It has no friction of its own: that of the ground holds.</p>}
      {link.same > 1 && (
        <p class="hint">
          {link.same} links have the file {link.file.split('/').at(-1)}: they change together.
        </p>
      )}
    </>
  );
}
