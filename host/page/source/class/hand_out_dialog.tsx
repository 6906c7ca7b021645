// Gives a scenario to learners: a copy in a new folder of each, and a line on their pages.
import { useSignal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import { close, Dialog } from '../panels/dialog.js';
import type { ClassProject, ClassSeat, HandOutResult } from '../wire/messages.js';
import type { ClassApp } from './class_app.js';
import { LearnerChoice, seatsOf } from './learner_choice.js';
import { groupsOf, matching } from './projects.js';

function ProjectList({ projects, chosen, choose }: { projects: readonly ClassProject[]; chosen: string | null; choose(file: string): void }) {
  return (
    <div class="project-list" tabIndex={0} role="group" aria-label="Scenarios">
      {groupsOf(projects).map(([group, members]) => (
        <section key={group} aria-label={group}>
          <h3>{group}</h3>
          {members.map(({ file, title, text }) => (
            <button key={file} type="button" aria-pressed={file === chosen} title={file} onClick={() => choose(file)}>
              <strong>{title}</strong>
              <span>{text}</span>
            </button>
          ))}
        </section>
      ))}
    </div>
  );
}

function Result({ result, learners }: { result: HandOutResult; learners: readonly ClassSeat[] }) {
  const nameOf = (seat: number) => learners.find((learner) => learner.seat === seat)?.name ?? `seat ${seat}`;
  return (
    <>
      <p role="status">
        {result.handed.length === 0 ? 'Nobody has it.' : `Handed out to ${result.handed.length}. Their pages offer to open it.`}
      </p>
      <ul class="hand-out-result" data-testid="hand-out-result">
        {result.handed.map(({ seat, file }) => (
          <li key={seat}>
            <strong>{nameOf(seat)}</strong> <span class="hint">{file}</span>
          </li>
        ))}
        {result.failed.map(({ seat, error }) => (
          <li key={seat} class="problem">
            <strong>{nameOf(seat)}</strong> {error}
          </li>
        ))}
      </ul>
      <button type="button" class="primary" onClick={close}>
        Done
      </button>
    </>
  );
}

export function HandOutDialog({ app, seat }: { app: ClassApp; seat: ClassSeat | null }) {
  const projects = useSignal<readonly ClassProject[] | null>(null);
  const wanted = useSignal('');
  const file = useSignal<string | null>(null);
  const chosen = useSignal<ReadonlySet<number> | null>(seat === null ? null : new Set([seat.seat]));
  const isBusy = useSignal(false);
  const problem = useSignal('');
  const result = useSignal<HandOutResult | null>(null);
  const learners = app.room.value?.learners ?? [];
  useEffect(() => {
    app.operations.ask('class.projects', {}).then(
      (value) => (projects.value = (value as { projects: ClassProject[] }).projects),
      (error: Error) => (problem.value = error.message),
    );
  }, []);
  const handOut = async () => {
    isBusy.value = true;
    try {
      result.value = (await app.operations.ask('class.hand_out', { file: file.value ?? '', ...seatsOf(chosen) })) as HandOutResult;
    } catch (error) {
      problem.value = (error as Error).message;
    }
    isBusy.value = false;
  };
  const title = seat === null ? 'Hand out' : `Hand out to ${seat.name}`;
  if (result.value !== null) {
    return (
      <Dialog title={title}>
        <Result result={result.value} learners={learners} />
      </Dialog>
    );
  }
  const found = matching(projects.value ?? [], wanted.value);
  const isReady = file.value !== null && chosen.value?.size !== 0 && learners.length > 0 && !isBusy.value;
  return (
    <Dialog title={title}>
      <div class="class-form">
        <p class="hint">Each learner gets a copy in a new folder. Nothing is overwritten.</p>
        <label for="project-search">Find a scenario</label>
        <input id="project-search" type="search" value={wanted.value} onInput={(event) => (wanted.value = event.currentTarget.value)} />
        <p class="hint" role="status">
          {projects.value === null ? 'Reading the folders …' : found.length === 0 ? 'Nothing has these words.' : found.length === 1 ? '1 scenario' : `${found.length} scenarios`}
        </p>
        <ProjectList projects={found} chosen={file.value} choose={(next) => (file.value = next)} />
        {seat === null && <LearnerChoice learners={learners} chosen={chosen} />}
        <p class="problem" role="alert">
          {problem.value}
        </p>
        <div class="fields">
          <button type="button" class="primary" disabled={!isReady} onClick={() => void handOut()}>
            {isBusy.value ? 'Copying …' : 'Hand out'}
          </button>
          <button type="button" onClick={close}>
            Cancel
          </button>
          {learners.length === 0 && <span class="hint">Nobody has joined yet.</span>}
        </div>
      </div>
    </Dialog>
  );
}
