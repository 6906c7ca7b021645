// What is wrong with the bus and the robot, the most important fault first.
import { resultOf } from '../wire/module_messages.js';
import { JobButton, JobObstacle } from './job_controls.js';
import type { ModulesApp } from './modules_app.js';

// Numbers and short texts; lists are for programs.
function observationLines(observations: Record<string, unknown>): string[] {
  return Object.entries(observations).flatMap(([name, value]) => {
    const isShort = typeof value === 'number' || typeof value === 'string' || typeof value === 'boolean';
    const text = typeof value === 'number' && !Number.isInteger(value) ? value.toPrecision(3) : String(value);
    return isShort ? [`${name.replaceAll('_', ' ')}: ${text}`] : [];
  });
}

export function DoctorPart({ app }: { app: ModulesApp }) {
  const result = resultOf(app.lastOf('examine'), 'examine');
  return (
    <>
      <p class="hint">It listens, and asks all nodes. It only reads. Deal with the first fault, then look again: what a fault explains is not listed.</p>
      <div class="fields">
        <JobButton app={app} isPrimary needsControl={false} title="Takes two seconds or more" run={() => void app.tell('modules.examine', {})}>
          {result === null ? 'Look' : 'Look again'}
        </JobButton>
        <JobObstacle app={app} needsControl={false} />
      </div>
      {result !== null && (
        <div data-testid="findings">
          {result.findings.length === 0 ? (
            <p class="verdict good">Nothing is wrong.</p>
          ) : (
            <ol class="finding-list">
              {result.findings.map(({ code, what, to_do, nodes }) => (
                <li key={`${code} ${what}`}>
                  <strong>{what}</strong>
                  <p>{to_do}</p>
                  {nodes.length > 0 && (
                    <p class="fields">
                      {nodes.map((node) => (
                        <button key={node} type="button" onClick={() => app.choose(node)}>
                          node {node}
                        </button>
                      ))}
                    </p>
                  )}
                </li>
              ))}
            </ol>
          )}
          <p class="hint observations">{observationLines(result.observations ?? {}).join('; ')}</p>
        </div>
      )}
    </>
  );
}
