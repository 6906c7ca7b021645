// The job that goes on, or has ended last: one place for all of them.
import { useSignal } from '@preact/signals';
import { copyIcon } from '../panels/icons.js';
import type { ModuleJob } from '../wire/messages.js';
import { isRunning, jobState, jobTitle } from './job_text.js';
import type { ModulesApp } from './modules_app.js';

function Command({ text }: { text: string }) {
  const copied = useSignal<string | null>(null);
  const copy = async () => {
    await navigator.clipboard.writeText(text);
    copied.value = text;
  };
  return (
    <div class="job-command">
      <code title="What does the same in a shell">{text}</code>
      <button type="button" onClick={() => void copy()}>
        {copyIcon} {copied.value === text ? 'Copied' : 'Copy'}
      </button>
    </div>
  );
}

function Ending({ job }: { job: ModuleJob }) {
  if (job.error === null) return null;
  return (
    <p class="problem" role="alert">
      {job.error}
    </p>
  );
}

export function JobCard({ app }: { app: ModulesApp }) {
  const job = app.job.value;
  if (job === null) return null;
  const { text, tone } = jobState(job);
  const obstacle = app.answerObstacle();
  const goesOn = isRunning(job);
  return (
    <section class={`panel modules-panel job ${goesOn ? 'running' : ''}`} aria-label="Job" data-testid="job">
      <div class="fields">
        <h2>{jobTitle(job.kind)}</h2>
        <span role="status" class={`verdict ${tone}`} data-testid="job-state">
          {text}
        </span>
        <span class="hint">begun by {job.by}</span>
        {goesOn && (
          <button
            type="button"
            disabled={obstacle !== null || job.state === 'ending'}
            title={obstacle ?? (job.state === 'ending' ? 'It ends.' : 'It ends as with Ctrl-C. A module that installs an image goes on by itself.')}
            onClick={() => app.cancel()}
          >
            Cancel
          </button>
        )}
      </div>
      {goesOn && <progress aria-label="The job goes on" />}
      <Ending job={job} />
      <details>
        <summary>
          Command{job.lines.length > 0 && `, and ${job.lines.length === 1 ? '1 line' : `${job.lines.length} lines`} that it has printed`}
        </summary>
        <Command text={job.command} />
        {job.lines.length > 0 && (
          <pre class="job-lines" tabIndex={0} data-testid="job-lines">
            {job.lines.join('\n')}
          </pre>
        )}
      </details>
    </section>
  );
}
