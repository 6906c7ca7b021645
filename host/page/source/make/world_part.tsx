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
  const isChosen = app.isChosen(number);
  const kind = !object.editable
    ? `in ${object.file.split('/').at(-1)}`
    : object.group_size > 1
      ? `${object.group_size} parts`
      : object.shapes.map(({ type }) => type).join(', ');
  return (
    <li>
      <button type="button" aria-pressed={isChosen}  title="Shift: choose several"
        onClick={(event) => {
          const adds = event.shiftKey || event.ctrlKey;
          app.chooseObject(isChosen && !adds && app.chosenObjects.peek().length === 1 ? null : number, adds);
        }}
      >
        {object.name}
      </button>
      <span class="hint">
        {kind}
        {object.moves ? ', moves' : ''}
      </span>
    </li>
  );
}

// Copies go to other scenarios, too: those that are opened later, and those in other tabs.
function ClipboardButtons({ app }: { app: MakeApp }) {
  const chosen = app.chosenObjects.value;
  const isEditable = chosen.every((number) => app.objects.value[number]?.editable === true);
  const why = chosen.length === 0 ? 'Choose an object first.' : isEditable ? null : 'It is in a file of its own, and can be copied there.';
  const obstacle = app.obstacle();
  return (
    <div class="fields" role="group" aria-label="Clipboard">
      <button type="button" disabled={why !== null} title={why ?? 'Ctrl + C'} onClick={() => void app.copy()}>
        Copy
      </button>
      <button type="button" disabled={(why ?? obstacle) !== null} title={why ?? obstacle ?? 'Ctrl + X'} onClick={() => void app.cut()}>
        Cut
      </button>
      <button type="button" disabled={obstacle !== null} title={obstacle ?? 'Adds what was copied, in this scenario or in another one (Ctrl + V)'} onClick={() => void app.pasteFromClipboard()}>
        Paste
      </button>
    </div>
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
        <ClipboardButtons app={app} />
        <ObjectForm app={app} />
      </section>
      <section class="panel make-panel" aria-label="Start of the robot">
        <h2>Start of the robot</h2>
        <StartForm app={app} />
      </section>
    </>
  );
}
