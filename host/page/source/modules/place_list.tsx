// The joints of the robot as a list: which have their module, and which one has moved.
import type { ModulesApp } from './modules_app.js';
import { serialText } from './module_rows.js';

const manyJoints = 12; // from then on in several columns

function Answers({ app }: { app: ModulesApp }) {
  const { places } = app;
  const why = app.answers.obstacle.value;
  return (
    <>
      <form
        class="fields"
        onSubmit={(event) => {
          event.preventDefault();
          places.answerTyped();
        }}
      >
        <label class="number-field">
          <span>number or name</span>
          <input type="text" size={6} name="place" autocomplete="off" spellcheck={false} value={places.typed.value} onInput={(event) => (places.typed.value = event.currentTarget.value)} />
        </label>
        <button type="submit" disabled={why !== null || places.typed.value === ''} title={why ?? 'This joint has moved (Enter)'}>
          This one
        </button>
      </form>
      <div class="fields">
        <button type="button" disabled={why !== null} title={why ?? 'What has moved is no joint of this robot'} onClick={() => places.answer('none')}>
          No joint of this robot
        </button>
        <button type="button" disabled={why !== null} title={why ?? 'The joint moves farther'} onClick={() => places.answer('more')}>
          Larger motion
        </button>
        <button type="button" disabled={why !== null} title={why ?? 'Nothing is changed'} onClick={() => places.answer('quit')}>
          End
        </button>
      </div>
    </>
  );
}

export function PlaceList({ app }: { app: ModulesApp }) {
  const { places } = app;
  const joints = app.modules.value?.robot?.joints ?? [];
  const placed = places.placed.value;
  const isAsked = places.question.value?.question === 'joint';
  const hovered = places.view.selection.hoveredJoint;
  return (
    <section class="place-list" aria-label="Joints of the robot">
      <ol aria-label="Joints, from the head to the tail" class={joints.length > manyJoints ? 'many' : ''}>
        {joints.map(({ name, node }, i) => {
          const module = placed.get(name);
          const state = module === undefined ? '' : `has its module: ${serialText(module.serial)}`;
          return (
            <li key={name} class={`${module === undefined ? '' : 'placed'} ${hovered.value === i ? 'hovered' : ''}`} onPointerEnter={() => (hovered.value = i)} onPointerLeave={() => (hovered.value = null)}>
              <button
                type="button"
                disabled={!places.canPlace.value}
                title={places.canPlace.value ? 'This joint has moved' : isAsked ? (app.answers.obstacle.value ?? '') : 'No joint is asked for now.'}
                onClick={() => places.answer(name)}
              >
                {name}
              </button>
              <span class="hint">
                node {node}
                {state !== '' && ` ✓ ${state}`}
              </span>
            </li>
          );
        })}
      </ol>
      {isAsked && <Answers app={app} />}
      <p class="hint">The list begins at the head. In the picture, joints that have their module are lit; a click on a joint, or on the link in front of it, is an answer, too.</p>
    </section>
  );
}
