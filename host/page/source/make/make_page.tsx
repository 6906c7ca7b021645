// The page Make: the scenario from above, from the side and in 3D, where the robot will go in it, and its parts: robot,
// behaviour, world, run, search.
import { useLayoutEffect } from 'preact/hooks';
import { LaterView, loadLater, loadWhenIdle } from '../panels/later_view.js';
import { ScenePanel } from '../panels/scene_panel.js';
import { namedJoints } from '../state/named_joints.js';
import { engineText } from '../state/robot_text.js';
import { openDialog } from '../view/dialogs.js';
import { isTextField } from '../view/keyboard.js';
import type { ForesightDocument } from '../wire/messages.js';
import { AlgorithmOfferBand } from './algorithm_offer_band.js';
import { AlgorithmPart } from './algorithm/algorithm_part.js';
import { BehaviourPart } from './behaviour_part.js';
import { MakeApp, partNames, type MakeStores, type PartName } from './make_app.js';
import { MeshDrop } from './mesh_drop.js';
import { LossQuestion, NewPanel } from './new_panel.js';
import { OpenPanel } from './open_panel.js';
import { RobotPart } from './robot_part.js';
import { FileList, RunForm } from './run_form.js';
import { SavePanel } from './save_panel.js';
import type { SearchHost } from './search/search_host.js';
import { WorldMap } from './world_map.js';
import { WorldPart } from './world_part.js';

// The part Search is loaded when it is first shown, or when the browser has nothing else to do.
const searchPart = loadLater<SearchHost>(() => import('./search/search_part.js').then((module) => module.SearchPart));
const chosenSearch = loadLater<SearchHost>(() => import('./search/search_part.js').then((module) => module.ChosenSearchView));
const sweepPart = loadLater<SearchHost>(() => import('./sweep/sweep_part.js').then((module) => module.SweepPart));
const chosenSweep = loadLater<SearchHost>(() => import('./sweep/sweep_part.js').then((module) => module.ChosenSweepView));
loadWhenIdle([searchPart, chosenSearch, sweepPart, chosenSweep]);

let make: MakeApp | null = null; // the only one of the page; it stays when another page is shown

function Bar({ app }: { app: MakeApp }) {
  const draft = app.draft.value;
  const obstacle = app.obstacle();
  const isOnBus = app.page.state.robot.value?.kind === 'bus';
  const count = draft?.changed.length ?? 0;
  return (
    <div class="make-bar">
      <h1 class="name" title={draft?.file} data-testid="draft-file">
        {draft?.file.split('/').at(-1)}
      </h1>
      <span class="hint" data-testid="draft-state">
        {draft?.has_file === false ? 'not saved yet' : count === 0 ? 'saved' : count === 1 ? '1 file changed' : `${count} files changed`}
      </span>
      <button type="button" aria-pressed={app.panel.value === 'new'} title="A robot, its gait and its world in four steps (N)" onClick={() => app.toggle('new')}>
        New …
      </button>
      <button
        type="button"
        aria-pressed={app.panel.value === 'open'}
        title="Shows the scenarios of the project, and those that ship with Proleg (Ctrl + O)"
        onClick={() => app.toggle('open')}
      >
        Open …
      </button>
      <button
        type="button"
        disabled={obstacle !== null || draft?.undo === null}
        title={obstacle ?? (draft?.undo === null ? 'There is nothing to undo.' : `Undo: ${draft?.undo} (Ctrl + Z)`)}
        onClick={() => void app.travel('draft.undo')}
      >
        Undo
      </button>
      <button
        type="button"
        disabled={obstacle !== null || draft?.redo === null}
        title={obstacle ?? (draft?.redo === null ? 'There is nothing to do again.' : `Redo: ${draft?.redo} (Ctrl + Y)`)}
        onClick={() => void app.travel('draft.redo')}
      >
        Redo
      </button>
      <button
        type="button"
        aria-pressed={app.panel.value === 'save'}
        title="Shows the changes, and writes them (Ctrl + S)"
        onClick={() => app.toggle('save')}
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
  return (
    <div class="band info" role="status" data-testid="unsaved">
      There are changes that were not saved, of {new Date(unsaved.time_ms).toLocaleString()}: {unsaved.files.join(', ')}.{' '}
      <button type="button" disabled={isDisabled} onClick={() => void app.restore()}>
        Restore
      </button>{' '}
      <button type="button" disabled={isDisabled} onClick={() => void app.page.operations.tell('draft.discard', {})}>
        Discard
      </button>
    </div>
  );
}

function foresightText(foresight: ForesightDocument, joints: readonly { name: string }[]): string {
  if (foresight.failure !== null) {
    return `After ${foresight.seconds.toFixed(1)} s: ${namedJoints(foresight.failure, joints)}`;
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
    <p class={isNew ? 'foresight-text' : 'foresight-text old'} role="status" tabIndex={0} data-testid="foresight">
      <i class="mark path" /> <strong>The next half minute:</strong>{' '}
      {foresight === null ? 'computing …' : foresightText(foresight, app.page.state.draftRobot.value?.joints ?? [])}
      {foresight !== null && <span class="hint"> ({engineText(foresight.engine, draft?.run.engine ?? foresight.engine)})</span>}
      {foresight?.refusal != null && <span class="servo-problem"> The engine that Run has cannot simulate this scenario: {foresight.refusal}</span>}
      {foresight?.servo_problem != null && <span class="servo-problem"> {foresight.servo_problem}</span>}
    </p>
  );
}

const partTitles: Record<PartName, string> = { robot: 'Robot', behaviour: 'Behaviour', algorithm: 'Algorithm', world: 'World', run: 'Run', search: 'Search' };

// Which part of the draft is at the side of the drawings.
function PartTabs({ app }: { app: MakeApp }) {
  return (
    <div class="tabs" role="tablist" aria-label="Parts">
      {partNames.map((name) => (
        <button
          key={name}
          type="button"
          role="tab"
          id={`tab-${name}`}
          aria-selected={app.part.value === name}
          aria-controls="make-part"
          tabIndex={app.part.value === name ? 0 : -1}
          onClick={() => (app.part.value = name)}
          onKeyDown={(event) => {
            const by = event.key === 'ArrowRight' ? 1 : event.key === 'ArrowLeft' ? -1 : 0;
            if (by === 0) return;
            event.preventDefault();
            event.stopPropagation();
            const next = partNames[(partNames.indexOf(name) + by + partNames.length) % partNames.length] as PartName;
            app.part.value = next;
            document.getElementById(`tab-${next}`)?.focus();
          }}
        >
          {partTitles[name]}
        </button>
      ))}
    </div>
  );
}

function Part({ app }: { app: MakeApp }) {
  switch (app.part.value) {
    case 'robot':
      return <RobotPart app={app} />;
    case 'behaviour':
      return <BehaviourPart app={app} />;
    case 'algorithm':
      return <AlgorithmPart app={app} />;
    case 'world':
      return <WorldPart app={app} />;
    case 'search':
      return (
        <>
          <LaterView app={app.search} part={searchPart()} wait="Loading …" />
          <LaterView app={app.search} part={sweepPart()} wait="" />
        </>
      );
    case 'run':
      return (
        <section class="panel make-panel" aria-label="Run">
          <h2>Run</h2>
          <RunForm app={app} />
          <h2>Files</h2>
          <FileList app={app} />
        </section>
      );
  }
}

// What is pasted outside text fields is for the part that is shown.
function listenToPaste(app: MakeApp): () => void {
  const onPaste = (event: ClipboardEvent) => {
    if (isTextField(event.composedPath()[0] ?? null) || openDialog.peek() !== 'none' || app.draft.peek() === null) return;
    event.preventDefault();
    const obstacle = app.obstacle();
    if (obstacle !== null) app.page.state.addNotice('warning', obstacle);
    else void app.paste(event.clipboardData?.getData('text/plain') ?? '');
  };
  document.addEventListener('paste', onPaste);
  return () => document.removeEventListener('paste', onPaste);
}

export function MakePage({ app: page }: { app: MakeStores }) {
  make ??= new MakeApp(page);
  const app = make;
  useLayoutEffect(() => listenToPaste(app), []);
  const draft = app.draft.value;
  if (draft === null) {
    return (
      <div class="make">
        <div class="make-bar">
          <h1 class="name">No scenario is open</h1>
          <button type="button" aria-pressed={app.panel.value === 'new'} title="A robot, its gait and its world in four steps (N)" onClick={() => app.toggle('new')}>
            New …
          </button>
          <button type="button" aria-pressed={app.panel.value === 'algorithm'} title="Algorithms of your own" onClick={() => app.toggle('algorithm')}>
            Algorithm …
          </button>
        </div>
        <AlgorithmOfferBand app={app} />
        {app.panel.value === 'new' ? (
          <div key="new">
            <NewPanel app={app} />
          </div>
        ) : app.panel.value === 'algorithm' ? (
          <AlgorithmPart app={app} />
        ) : (
          <OpenPanel app={app} />
        )}
      </div>
    );
  }
  return (
    <div class="make">
      <MeshDrop app={app} />
      <Bar app={app} />
      <AlgorithmOfferBand app={app} />
      {app.panel.value === 'save' && <SavePanel app={app} />}
      {app.panel.value === 'open' && (app.wouldLose() ? <LossQuestion app={app} /> : <OpenPanel app={app} />)}
      <Unsaved app={app} />
      {draft.warnings.map((warning) => (
        <div class="band info" role="status" key={warning}>
          {warning}
        </div>
      ))}
      <div class="make-main">
        {app.part.value === 'search' && (app.search.chosenSearch.value !== null || app.search.chosenSweep.value !== null) ? (
          <LaterView app={app.search} part={app.search.chosenSweep.value === null ? chosenSearch() : chosenSweep()} wait="Loading …" />
        ) : (
          <section class="panel make-maps" aria-label="Maps">
            <WorldMap app={app} plane="top" />
            <WorldMap app={app} plane="side" />
            <Foresight app={app} />
          </section>
        )}
        <ScenePanel app={app.view} />
      </div>
      {app.panel.value === 'new' ? (
        // With its key it is the same one, and keeps the focus, when the first draft comes.
        <div key="new" class="make-side make-new">
          <NewPanel app={app} />
        </div>
      ) : (
        <div class="make-side">
          <PartTabs app={app} />
          <div class="make-part" role="tabpanel" id="make-part" aria-labelledby={`tab-${app.part.value}`}>
            <Part app={app} />
          </div>
        </div>
      )}
    </div>
  );
}
