// A person turns the joint by hand to both ends; the module measures its potentiometer there.
import { useSignal } from '@preact/signals';
import type { ModuleJob } from '../wire/messages.js';
import { resultOf } from '../wire/module_messages.js';
import { isRunning } from './job_text.js';
import type { ModulesApp } from './modules_app.js';

const steps = [
  { question: 'lower', degrees: '−90°' },
  { question: 'upper', degrees: '+90°' },
] as const;
const largestReading = 4095;

function Reading({ job }: { job: ModuleJob }) {
  const reading = job.latest.reading;
  if (reading === undefined) return <p class="hint">The module is asked …</p>;
  return (
    <div class="fields reading">
      <meter min={0} max={largestReading} value={reading.reading} aria-label="Reading of the potentiometer" />
      <strong data-testid="reading">{reading.reading}</strong>
      <span class="hint">of {largestReading}</span>
      {reading.angle !== null && <span>now taken as {reading.angle.toFixed(1)}°</span>}
    </div>
  );
}

function Step({ app, job }: { app: ModulesApp; job: ModuleJob }) {
  const { obstacle, refused } = app.answers;
  const now = steps.findIndex((step) => step.question === job.question?.question);
  const why = obstacle.value;
  return (
    <>
      <ol class="steps" aria-label="Steps">
        {steps.map(({ degrees }, i) => (
          <li key={degrees} aria-current={i === now ? 'step' : undefined}>
            {i + 1}. {degrees}
          </li>
        ))}
      </ol>
      <Reading job={job} />
      {refused.value !== null && (
        <p class="problem" role="alert">
          {refused.value}
        </p>
      )}
      {now >= 0 && (
        <p class="instruction" role="status">
          Turn the joint by hand to <strong>{steps[now]?.degrees}</strong> and hold it there.
        </p>
      )}
      <div class="fields">
        <button type="button" class="primary large" disabled={why !== null} title={why ?? 'The joint is there'} onClick={() => void app.answers.answer('here')}>
          Here
        </button>
        <button type="button" disabled={why !== null} title={why ?? 'Nothing is changed'} onClick={() => void app.answers.answer('quit')}>
          End
        </button>
        {why !== null && <span class="hint">{why}</span>}
      </div>
    </>
  );
}

export function CalibrationView({ app }: { app: ModulesApp }) {
  const closed = useSignal(-1);
  const job = app.job.value;
  if (job === null || job.kind !== 'calibrate' || closed.value === job.number) return null;
  const node = job.latest.reading?.node ?? (job.question !== null && 'node' in job.question ? job.question.node : null);
  const now = resultOf(job, 'calibrate')?.now;
  return (
    <section class="calibration" aria-label="Calibrate" data-testid="calibration">
      <h3>Potentiometer{node === null ? '' : ` of node ${node}`}</h3>
      {isRunning(job) ? (
        <Step app={app} job={job} />
      ) : (
        <div class="fields">
          <p class={job.status === 0 ? 'verdict good' : 'verdict bad'} role="status">
            {job.status === 0 ? 'The module has stored it.' : 'Nothing is stored.'} {now === undefined ? (job.error ?? job.ended_by) : `It reads ${now.at_minus_90} at −90° and ${now.at_plus_90} at +90°.`}
          </p>
          <button type="button" onClick={() => (closed.value = job.number)}>
            Close
          </button>
        </div>
      )}
    </section>
  );
}
