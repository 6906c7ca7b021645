// The behaviour as a matrix: rows are actuation modules, columns are joints from the tail to the head. A joint adds up what
// all modules of its column give.
import { useRef } from 'preact/hooks';
import type { AlgorithmDocument, BehaviourModule, DraftRobot } from '../wire/messages.js';
import { algorithmTitle, fromTail } from '../state/robot_text.js';
import type { MakeApp } from './make_app.js';
import { ModuleForm } from './module_form.js';

interface Paint {
  module: number;
  isOn: boolean;
  joints: Set<number>;
  gesture: number;
}

function ModuleRow({ app, robot, module, number, paint }: {
  app: MakeApp;
  robot: DraftRobot;
  module: BehaviourModule;
  number: number;
  paint: { current: Paint | null };
}) {
  const isDisabled = app.obstacle() !== null;
  const isChosen = app.chosenModule.value === number;
  const moved = app.jointsOf(number);
  const send = (state: Paint) => app.setJoints(state.module, [...state.joints].sort((a, b) => a - b), state.gesture);
  const toggle = (joint: number) => {
    const joints = new Set(app.jointsOf(number));
    const isOn = !joints.delete(joint);
    if (isOn) joints.add(joint);
    const state: Paint = { module: number, isOn, joints, gesture: app.page.newGesture() };
    app.chosenModule.value = number;
    send(state);
    return state;
  };
  // Cells that the pointer passes while it is down become as the first one.
  const enter = (joint: number) => {
    const state = paint.current;
    if (state === null || state.module !== number || state.joints.has(joint) === state.isOn) return;
    if (state.isOn) state.joints.add(joint);
    else state.joints.delete(joint);
    send(state);
  };
  return (
    <tr>
      <th scope="row">
        <button type="button" aria-pressed={isChosen} title={module.algorithm} onClick={() => (app.chosenModule.value = number)}>
          {number + 1}. {algorithmTitle(module.algorithm)}
        </button>
      </th>
      {fromTail(robot.joints.length).map((joint) => {
        const isOn = moved.includes(joint);
        const name = robot.joints[joint]!.name;
        return (
          <td key={joint}>
            <button
              type="button"
              class={isOn ? 'cell on' : 'cell'}
              disabled={isDisabled}
              aria-pressed={isOn}
              aria-label={`module ${number + 1} moves ${name}`}
              title={`${name}: ${isOn ? 'moved' : 'not moved'} by module ${number + 1}. Drag over several.`}
              onPointerDown={(event) => {
                if (event.button !== 0) return;
                event.currentTarget.releasePointerCapture?.(event.pointerId);
                paint.current = toggle(joint);
              }}
              onPointerEnter={() => enter(joint)}
              onClick={(event) => {
                if (event.detail === 0) toggle(joint); // a key; the pointer has had its effect
              }}
            >
              {isOn ? '●' : ''}
            </button>
          </td>
        );
      })}
    </tr>
  );
}

function AddModule({ app, robot, algorithms }: { app: MakeApp; robot: DraftRobot; algorithms: readonly AlgorithmDocument[] }) {
  const modules = app.draft.value?.behaviour.modules ?? [];
  const most = app.page.state.parts.value?.most_modules ?? 4;
  const obstacle = app.obstacle() ?? (modules.length >= most ? `A robot has at most ${most} actuation modules.` : null);
  const add = async (algorithm: string) => {
    const joints = Array.from({ length: robot.joints.length }, (_, i) => i);
    if (await app.changes.tell('behaviour.add', { algorithm, joints })) app.chosenModule.value = modules.length;
  };
  return (
    <details class="add-module">
      <summary>Add a gait or a reflex</summary>
      <ul class="objects">
        {algorithms.map(({ name, help, own: isUser }) => (
          <li key={name}>
            <button type="button" disabled={obstacle !== null} title={obstacle ?? 'It moves all joints at first.'} onClick={() => void add(name)}>
              {algorithmTitle(name)}
            </button>
            <span class="hint">
              {help}
              {isUser ? ' (your own)' : ''}
            </span>
          </li>
        ))}
      </ul>
    </details>
  );
}

export function BehaviourPart({ app }: { app: MakeApp }) {
  const paint = useRef<Paint | null>(null);
  const draft = app.draft.value;
  if (draft === null) return null;
  const { robot, behaviour } = draft;
  const algorithms = app.page.state.algorithms.value;
  const order = fromTail(robot.joints.length);
  const chosen = Math.min(app.chosenModule.value, behaviour.modules.length - 1);
  const module = behaviour.modules[chosen];
  const count = (joint: number) => behaviour.modules.filter((_, number) => app.jointsOf(number).includes(joint)).length;
  return (
    <>
      <section class="panel make-panel" aria-label="Behaviour">
        <h2>What moves which joint</h2>
        <div class="chain" data-testid="matrix" onPointerUp={() => (paint.current = null)} onPointerLeave={() => (paint.current = null)}>
          <table>
            <caption>From the tail to the head. Outputs on the same joint are added.</caption>
            <thead>
              <tr>
                <th scope="col">module</th>
                {order.map((joint) => (
                  <th scope="col" key={joint}>
                    {robot.joints[joint]!.name}
                  </th>
                ))}
              </tr>
            </thead>
            <tbody>
              {behaviour.modules.map((each, number) => (
                <ModuleRow key={number} app={app} robot={robot} module={each} number={number} paint={paint} />
              ))}
              <tr class="sum">
                <th scope="row">together</th>
                {order.map((joint) => (
                  <td key={joint} title={count(joint) === 0 ? 'stays straight' : count(joint) === 1 ? 'one module' : `the sum of ${count(joint)} modules`}>
                    {count(joint) === 0 ? 'still' : count(joint) === 1 ? '1' : `Σ ${count(joint)}`}
                  </td>
                ))}
              </tr>
            </tbody>
          </table>
        </div>
        <AddModule app={app} robot={robot} algorithms={algorithms} />
      </section>
      {module !== undefined && (
        <ModuleForm key={`${chosen} ${module.algorithm}`} app={app} robot={robot} module={module} number={chosen} algorithms={algorithms} isOnly={behaviour.modules.length === 1} />
      )}
    </>
  );
}
