// The world: the library, the objects, and where the robot starts.
import type { WorldObject } from '../wire/messages.js';
import { LibraryPanel } from './library_panel.js';
import type { MakeApp } from './make_app.js';
import { ObjectForm, StartForm } from './object_form.js';

function isFirstOfGroup(objects: readonly WorldObject[], number: number): boolean {
  const { group, group_size: size } = objects[number] as WorldObject;
  return size === 1 || objects.findIndex((other) => other.group === group) === number;
}

// An object, or a group of them.
function ObjectRow({ app, object, number }: { app: MakeApp; object: WorldObject; number: number }) {
  const chosen = app.chosenObject.value;
  const isChosen = app.chosen.value === number || (chosen !== null && object.group_size > 1 && chosen.group === object.group);
  const kind = !object.editable
    ? `in ${object.file.split('/').at(-1)}`
    : object.group_size > 1
      ? `${object.group_size} parts`
      : object.shapes.map(({ type }) => type).join(', ');
  return (
    <li>
      <button type="button" aria-pressed={isChosen} onClick={() => (app.chosen.value = isChosen ? null : number)}>
        {object.name}
      </button>
      <span class="hint">
        {kind}
        {object.moves ? ', moves' : ''}
      </span>
    </li>
  );
}

export function WorldPart({ app }: { app: MakeApp }) {
  const objects = app.objects.value;
  return (
    <>
      <LibraryPanel app={app} />
      <section class="panel make-panel" aria-label="Objects">
        <h2>Objects</h2>
        <ul class="objects">
          {objects.map((object, number) =>
            isFirstOfGroup(objects, number) ? <ObjectRow key={number} app={app} object={object} number={number} /> : null,
          )}
        </ul>
        <ObjectForm app={app} />
      </section>
      <section class="panel make-panel" aria-label="Start of the robot">
        <h2>Start of the robot</h2>
        <StartForm app={app} />
      </section>
    </>
  );
}
