// The page Make: the world of the scenario, from above, from the side and in 3D, and where the robot will go in it.
import { useSignal } from '@preact/signals';
import { ScenePanel } from '../panels/scene_panel.js';
import type { ForesightDocument, WorldObject } from '../wire/messages.js';
import { AlgorithmPart } from './algorithm/algorithm_part.js';
import { LibraryPanel } from './library_panel.js';
import { MakeApp, type MakeStores } from './make_app.js';
import { ObjectForm, StartForm } from './object_form.js';
import { RunForm } from './run_form.js';
import { SavePanel } from './save_panel.js';
import { WorldMap } from './world_map.js';

let make: MakeApp | null = null; // the only one of the page; it stays when another page is shown

function Bar({ app }: { app: MakeApp }) {
  const draft = app.draft.value;
  const obstacle = app.obstacle();
  const isOnBus = app.page.state.robot.value?.kind === 'bus';
  const tell = (name: 'draft.undo' | 'draft.redo') => void app.page.operations.tell(name, {});
  const count = draft?.changed.length ?? 0;
  return (
    <div class="make-bar">
      <h1 class="name" title={draft?.file} data-testid="draft-file">
        {draft?.file.split('/').at(-1)}
      </h1>
      <span class="hint" data-testid="draft-state">
        {count === 0 ? 'saved' : count === 1 ? '1 file changed' : `${count} files changed`}
      </span>
      <button
        type="button"
        disabled={obstacle !== null || draft?.undo === null}
        title={obstacle ?? (draft?.undo === null ? 'There is nothing to undo.' : `Undo: ${draft?.undo} (Ctrl + Z)`)}
        onClick={() => tell('draft.undo')}
      >
        Undo
      </button>
      <button
        type="button"
        disabled={obstacle !== null || draft?.redo === null}
        title={obstacle ?? (draft?.redo === null ? 'There is nothing to do again.' : `Redo: ${draft?.redo} (Ctrl + Y)`)}
        onClick={() => tell('draft.redo')}
      >
        Redo
      </button>
      <button
        type="button"
        aria-pressed={app.isSaving.value}
        title="Shows the changes, and writes them (Ctrl + S)"
        onClick={() => (app.isSaving.value = !app.isSaving.value)}
      >
        Save …
      </button>
      <button
        type="button"
        class="primary"
        disabled={obstacle !== null || isOnBus}
        title={
          isOnBus
            ? 'The page Live shows a robot on a bus.'
            : (obstacle ?? 'The simulation on the page Live becomes that of this scenario (Ctrl + Enter)')
        }
        onClick={() => void app.simulate()}
      >
        Simulate
      </button>
      {obstacle !== null && <span class="hint">{obstacle}</span>}
    </div>
  );
}

// Changes that an earlier program did not save.
function Unsaved({ app }: { app: MakeApp }) {
  const unsaved = app.draft.value?.unsaved ?? null;
  if (unsaved === null) return null;
  const isDisabled = app.obstacle() !== null;
  const tell = (name: 'draft.restore' | 'draft.discard') => void app.page.operations.tell(name, {});
  return (
    <div class="band info" role="status" data-testid="unsaved">
      There are changes that were not saved, of {new Date(unsaved.time_ms).toLocaleString()}: {unsaved.files.join(', ')}.{' '}
      <button type="button" disabled={isDisabled} onClick={() => tell('draft.restore')}>
        Restore
      </button>{' '}
      <button type="button" disabled={isDisabled} onClick={() => tell('draft.discard')}>
        Discard
      </button>
    </div>
  );
}

function foresightText(foresight: ForesightDocument): string {
  if (foresight.failure !== null) {
    return `After ${foresight.seconds.toFixed(1)} s: ${foresight.failure}`;
  }
  const distance = foresight.distance === null ? '' : `${foresight.distance.toFixed(2)} m in ${foresight.seconds.toFixed(0)} s`;
  return `${distance}${foresight.heading === null ? '' : `, ${wayText(foresight.heading)}`}`;
}

// A direction in degrees to the left of the head's, in words.
function wayText(heading: number): string {
  const straight = 10; // degrees
  if (Math.abs(heading) < straight) return 'straight ahead';
  if (Math.abs(heading) > 180 - straight) return 'straight back';
  return `${Math.abs(heading).toFixed(0)}° to the ${heading > 0 ? 'left' : 'right'}`;
}

function Foresight({ app }: { app: MakeApp }) {
  const foresight = app.page.state.foresight.value;
  const draft = app.draft.value;
  const isNew = foresight !== null && draft !== null && foresight.revision === draft.revision;
  return (
    <p class={isNew ? 'foresight-text' : 'foresight-text old'} role="status" data-testid="foresight">
      <i class="mark path" /> <strong>The next half minute:</strong>{' '}
      {foresight === null ? 'computing …' : foresightText(foresight)}
      {foresight !== null && foresight.engine !== 'reduced' && (
        <span class="hint" title="The reduced engine, which is faster, does not have such a world.">
          {' '}
          ({foresight.engine.toUpperCase()})
        </span>
      )}
      {foresight?.servo_problem != null && <span class="servo-problem"> {foresight.servo_problem}</span>}
    </p>
  );
}

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

export function MakePage({ app: page }: { app: MakeStores }) {
  make ??= new MakeApp(page);
  const app = make;
  const draft = app.draft.value;
  const hasAlgorithmPart = useSignal(false);
  if (draft === null) {
    return (
      <p class="wait">
        There is no scenario to change. Start <code>proleg ui</code> with one, or without a file.
      </p>
    );
  }
  return (
    <div class="make">
      <Bar app={app} />
      {app.isSaving.value && <SavePanel app={app} />}
      <Unsaved app={app} />
      {draft.warnings.map((warning) => (
        <div class="band info" role="status" key={warning}>
          {warning}
        </div>
      ))}
      <div class="make-main">
        <section class="panel make-maps" aria-label="Maps">
          <WorldMap app={app} plane="top" />
          <WorldMap app={app} plane="side" />
          <Foresight app={app} />
        </section>
        <ScenePanel app={app.view} />
      </div>
      <div class="make-side">
        <LibraryPanel app={app} />
        <section class="panel make-panel" aria-label="Objects">
          <h2>Objects</h2>
          <ul class="objects">
            {draft.world.objects.map((object, number) =>
              isFirstOfGroup(draft.world.objects, number) ? <ObjectRow key={number} app={app} object={object} number={number} /> : null,
            )}
          </ul>
          <ObjectForm app={app} />
        </section>
        <section class="panel make-panel" aria-label="Start of the robot">
          <h2>Start of the robot</h2>
          <StartForm app={app} />
        </section>
        <section class="panel make-panel" aria-label="Run">
          <h2>Run</h2>
          <RunForm app={app} />
        </section>
      </div>
      <button type="button" aria-pressed={hasAlgorithmPart.value} onClick={() => (hasAlgorithmPart.value = !hasAlgorithmPart.value)}>
        Algorithm
      </button>
      {hasAlgorithmPart.value && <AlgorithmPart app={app} />}
    </div>
  );
}
