// The numbers of the chosen object.
import { useSignal } from '@preact/signals';
import { arrayOf, headingOf } from '../geometry/outline.js';
import { poseFromArray, type Pose, type Vector } from '../geometry/quaternion.js';
import type { DraftDocument, WorldObject, WorldShape } from '../wire/messages.js';
import { fromHex, toHex } from './colour_text.js';
import type { MakeApp } from './make_app.js';
import { NumberField } from './fields/number_field.js';
import { TextField } from './fields/text_field.js';

const sizeLabels: Record<WorldShape['type'], readonly string[]> = {
  box: ['size x', 'size y', 'size z'],
  sphere: ['radius'],
  cylinder: ['radius', 'length'],
  heightfield: ['size x', 'size y'],
  trimesh: ['size x', 'size y', 'size z'],
};

const axes = ['x', 'y', 'z'] as const;

const axisTitles = ['to the right', 'the way of the robot', 'up'] as const;

interface Place {
  place: Vector;
  isDisabled: boolean;
  commit(moved: (old: Vector) => Vector): Promise<string | null>;
}

function replaced<Values extends readonly number[]>(values: Values, at: number, value: number): Values {
  return values.map((old, i) => (i === at ? value : old)) as unknown as Values;
}

function PlaceFields({ place, isDisabled, commit }: Place) {
  return (
    <>
      {axes.map((axis, i) => (
        <NumberField
          key={axis}
          label={axis}
          unit="m"
          value={place[i] as number}
          isDisabled={isDisabled}
          title={axisTitles[i] as string}
          commit={(value) => commit((old) => replaced(old, i, value))}
        />
      ))}
    </>
  );
}

// Copies in a row.
function CopyForm({ app }: { app: MakeApp }) {
  const step = useSignal<[number, number, number]>([0.5, 0, 0]);
  const count = useSignal(1);
  const problem = useSignal<string | null>(null);
  const isDisabled = app.obstacle() !== null;
  return (
    <fieldset class="copies">
      <legend>Copies</legend>
      <NumberField label="how many" value={count.value} decimals={0} isDisabled={isDisabled} commit={(value) => ((count.value = value), null)} />
      {axes.map((axis, i) => (
        <NumberField
          key={axis}
          label={`step ${axis}`}
          unit="m"
          value={step.value[i] as number}
          isDisabled={isDisabled}
          commit={(value) => {
            const next: [number, number, number] = [...step.value];
            next[i] = value;
            step.value = next;
            return null;
          }}
        />
      ))}
      <button
        type="button"
        disabled={isDisabled}
        title="Each copy is moved by the step from the one before (Ctrl + D: one copy)"
        onClick={async () => (problem.value = await app.duplicate(step.value, count.value))}
      >
        Duplicate
      </button>
      {problem.value !== null && (
        <p class="problem" role="alert">
          {problem.value}
        </p>
      )}
    </fieldset>
  );
}

export function ObjectForm({ app }: { app: MakeApp }) {
  const number = app.chosen.value;
  const object = app.chosenObject.value;
  const count = app.chosenObjects.value.length;
  if (count > 1) {
    return (
      <div class="object-form">
        <p>{count} objects</p>
        <CopyForm app={app} />
        <button type="button" disabled={app.obstacle() !== null} onClick={() => void app.remove()} title="Undo brings them back (Delete)">
          Delete {count} objects
        </button>
      </div>
    );
  }
  if (number === null || object === null) {
    return <p class="hint">Choose an object in the list, in a drawing or in the 3D view to see and change its numbers; with Shift several.</p>;
  }
  if (!object.editable) {
    return (
      <p class="hint">
        {object.name} is in a file of its own, {object.file}, which other worlds may use, too. It can be changed there.
      </p>
    );
  }
  const isDisabled = app.obstacle() !== null;
  const pose = app.poseOf(number, object);
  const place = (moved: (now: WorldObject) => Pose) =>
    app.changes.changeOf('world.place', ({ world }) => ({
      object: number,
      pose: arrayOf(moved(world.objects[number] ?? object)),
      group: object.group_size > 1,
    }));
  const resize = (k: number, size: (now: number[]) => number[]) =>
    app.changes.changeOf('world.resize', ({ world }) => ({
      object: number,
      shape: k,
      size: size(world.objects[number]?.shapes[k]?.size ?? []),
    }));
  const colour = object.shapes[0]?.colour ?? null;
  const friction = object.shapes[0]?.friction ?? null;
  return (
    <div class="object-form" key={number}>
      <TextField label="name" value={object.name} isDisabled={isDisabled} commit={(name) => app.changes.change('world.rename', { object: number, name })} />
      {object.group_size > 1 && <p class="hint">One of {object.group_size} parts, which move together. Ctrl and drag moves it alone.</p>}
      <div class="fields">
        <PlaceFields
          place={pose.position}
          isDisabled={isDisabled}
          commit={(position) =>
            place((now) => {
              const { position: old, orientation } = poseFromArray(now.pose);
              return { position: position(old), orientation };
            })
          }
        />
        <NumberField
          label="turn"
          unit="°"
          value={headingOf(pose)}
          decimals={2}
          isDisabled={isDisabled}
          title="to the left, about the vertical"
          commit={(value) => place((now) => app.turned(now, value))}
        />
      </div>
      {object.shapes.map((shape, k) => (
        <div class="fields" key={k}>
          {shape.size.map((value, i) => (
            <NumberField
              key={i}
              label={sizeLabels[shape.type][i] ?? 'size'}
              unit="m"
              value={value}
              isDisabled={isDisabled}
              commit={(next) => resize(k, (size) => replaced(size, i, next))}
            />
          ))}
          {shape.type === 'trimesh' && shape.size.length > 0 && (
            <NumberField
              label="scale by"
              value={1}
              isDisabled={isDisabled}
              title="All sides become so many times as long"
              commit={(by) => resize(k, (size) => size.map((side) => side * by))}
            />
          )}
          {shape.type === 'trimesh' && shape.size.length === 0 && <p class="hint">Its shape is a mesh in the file of the world.</p>}
        </div>
      ))}
      <div class="fields">
        <NumberField
          label="friction"
          value={friction ?? 0}
          isDisabled={isDisabled}
          title="How slippery it is: 0 is ice, 1 is rubber."
          commit={(value) => app.changes.change('world.friction', { object: number, value })}
        />
        <label class="number-field">
          <span>colour</span>
          <input
            type="color"
            value={toHex(colour ?? [0.7, 0.7, 0.7])}
            disabled={isDisabled}
            onChange={(event) => void app.changes.tell('world.colour', { object: number, value: fromHex(event.currentTarget.value) })}
          />
        </label>
        <label class="switch">
          <input
            type="checkbox"
            checked={object.moves}
            disabled={isDisabled}
            onChange={(event) => void app.changes.tell('world.moves', { object: number, value: event.currentTarget.checked })}
            onKeyDown={(event) => {
              if (event.key === 'Enter') void app.changes.tell('world.moves', { object: number, value: !object.moves }); // Space is STOP
            }}
          />
          moves when something pushes it
        </label>
        {object.mass !== null && (
          <NumberField
            label="mass"
            unit="kg"
            value={object.mass}
            isDisabled={isDisabled}
            commit={(value) => app.changes.change('world.mass', { object: number, value })}
          />
        )}
      </div>
      <CopyForm app={app} />
      <button type="button" disabled={isDisabled} onClick={() => void app.remove()} title="Undo brings it back (Delete)">
        Delete {object.group_size > 1 ? `all ${object.group_size} parts` : object.name}
      </button>
    </div>
  );
}

// Where the robot starts.
export function StartForm({ app }: { app: MakeApp }) {
  const start = app.draft.value?.world.start;
  if (start === undefined) return null;
  const isDisabled = app.obstacle() !== null;
  type Start = DraftDocument['world']['start'];
  const change = (changed: (now: Start) => Partial<Start>) =>
    app.changes.changeOf('world.start', ({ world }) => ({ ...world.start, ...changed(world.start) }));
  return (
    <div class="fields">
      <PlaceFields place={start.position} isDisabled={isDisabled} commit={(position) => change((now) => ({ position: [...position(now.position)] }))} />
      <NumberField
        label="turn"
        unit="°"
        value={start.degrees[2]}
        decimals={2}
        isDisabled={isDisabled}
        title="to the left, about the vertical"
        commit={(value) => change((now) => ({ degrees: replaced(now.degrees, 2, value) }))}
      />
      <p class="hint">
        The robot points to {headingOf(poseFromArray(app.draft.value?.head ?? [0, 0, 0, 1, 0, 0, 0])).toFixed(0)}°. In the ground it is
        lifted onto it.
      </p>
    </div>
  );
}
