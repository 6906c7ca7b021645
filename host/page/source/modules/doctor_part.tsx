// What is wrong with the bus and the robot, the most important fault first.
import { resultOf } from '../wire/module_messages.js';
import { JobButton, JobObstacle } from './job_controls.js';
import type { ModulesApp, TaskName } from './modules_app.js';

// The tasks of this page that do what a finding says is to be done.
const places = ['places', 'Places'] as const;
const recover = ['recover', 'Recover'] as const;
const flash = ['flash', 'Flash'] as const;
const helpers: Partial<Record<string, readonly (readonly [TaskName, string])[]>> = {
  module_without_node_id: [places, recover],
  duplicate_node_id: [recover],
  stopped_module: [recover],
  restarting_module: [recover],
  other_protocol: [flash],
  other_core: [flash],
};

// Numbers and short texts; lists are for programs.
function observationLines(observations: Record<string, unknown>): string[] {
  return Object.entries(observations).flatMap(([name, value]) => {
    const isShort = typeof value === 'number' || typeof value === 'string' || typeof value === 'boolean';
    const text = typeof value === 'number' && !Number.isInteger(value) ? value.toPrecision(3) : String(value);
    return isShort ? [`${name.replaceAll('_', ' ')}: ${text}`] : [];
  });
}

// What there is to do about a finding.
function FindingActions({ app, code, nodes }: { app: ModulesApp; code: string; nodes: readonly number[] }) {
  return (
    <p class="fields">
      {nodes.map((node) => (
        <button key={node} type="button" title="Shows the module" onClick={() => app.choose(node)}>
          node {node}
        </button>
      ))}
      {helpers[code]?.map(([task, title]) => (
        <button key={task} type="button" title="Shows what does it" onClick={() => app.show(task)}>
          {title}
        </button>
      ))}
    </p>
  );
}

// What the last examination has found; nothing before the first one.
export function Findings({ app }: { app: ModulesApp }) {
  const result = resultOf(app.lastOf('examine'), 'examine');
  if (result === null) return null;
  return (
    <div data-testid="findings">
      {result.findings.length === 0 ? (
        <p class="verdict good">Nothing is wrong.</p>
      ) : (
        <ol class="finding-list">
          {result.findings.map(({ code, what, to_do, nodes }) => (
            <li key={`${code} ${what}`}>
              <strong>{what}</strong>
              <p>{to_do}</p>
              {app.isOpen.value && <FindingActions app={app} code={code} nodes={nodes} />}
            </li>
          ))}
        </ol>
      )}
      <p class="hint observations">{observationLines(result.observations ?? {}).join('; ')}</p>
    </div>
  );
}

export function DoctorPart({ app }: { app: ModulesApp }) {
  return (
    <>
      <p class="hint">It listens, and asks all nodes. It only reads. Deal with the first fault, then look again: what a fault explains is not listed.</p>
      <div class="fields">
        <JobButton app={app} isPrimary needsControl={false} title="Takes two seconds or more" run={() => void app.tell('modules.examine', {})}>
          {app.lastOf('examine') === null ? 'Look' : 'Look again'}
        </JobButton>
        <JobObstacle app={app} needsControl={false} />
      </div>
      <Findings app={app} />
    </>
  );
}
