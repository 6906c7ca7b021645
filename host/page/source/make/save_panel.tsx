// The changes of the files, line by line, and the ways to save them.
import { useSignal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import type { DraftDiff } from '../wire/messages.js';
import { lineDiff } from './line_diff.js';
import { saveObstacle, type MakeApp } from './make_app.js';

const mostLines = 400; // of a file

function FileChanges({ file }: { file: DraftDiff['files'][number] }) {
  const changes = file.new === null ? null : lineDiff(file.old ?? '', file.new);
  return (
    <section aria-label={file.name}>
      <h3>{file.name}</h3>
      {changes === null ? (
        <p class="hint">
          {file.bytes >= 1024 ? `${Math.round(file.bytes / 1024)} KiB` : `${file.bytes} bytes`} that are not shown as text.
        </p>
      ) : (
        <div class="diff-lines">
          {changes.slice(0, mostLines).map(({ line, kind, text }, i) =>
            kind === 'removed' ? (
              <del key={i} title={`line ${line}`}>
                {text}
              </del>
            ) : (
              <ins key={i} title={`line ${line}`}>
                {text}
              </ins>
            ),
          )}
          {changes.length > mostLines && <span>… and {changes.length - mostLines} more lines</span>}
        </div>
      )}
    </section>
  );
}

export function SavePanel({ app }: { app: MakeApp }) {
  const diff = useSignal<DraftDiff | null>(null);
  const problem = useSignal<string | null>(null);
  const folder = useSignal('');
  const draft = app.draft.value;
  useEffect(() => {
    app.page.operations.ask('draft.diff', {}).then(
      (value) => (diff.value = value as DraftDiff),
      (error: Error) => (problem.value = error.message),
    );
  }, [draft?.revision, draft?.changed.length]);
  const obstacle = app.obstacle() ?? saveObstacle(draft);
  const finish = (ask: () => Promise<unknown>) =>
    app.changes.settled().then(ask).then(
      () => {
        app.panel.value = 'none';
      },
      (error: Error) => (problem.value = error.message),
    );
  return (
    <section class="panel make-panel" aria-label="Save" data-testid="save-panel">
      <div class="diff">
        {diff.value?.files.map((file) => <FileChanges key={file.name} file={file} />)}
        {diff.value?.files.length === 0 && <p class="hint">The files on disk are as they are here.</p>}
      </div>
      {problem.value !== null && (
        <p class="problem" role="alert">
          {problem.value}
        </p>
      )}
      <div class="fields">
        <button
          type="button"
          class="primary"
          disabled={obstacle !== null}
          title={obstacle ?? 'Writes these lines. Everything else in the files stays.'}
          onClick={() => void finish(() => app.page.operations.ask('draft.save', {}))}
        >
          Save
        </button>
        <form
          onSubmit={(event) => {
            event.preventDefault();
            void finish(() => app.page.operations.ask('draft.save_as', { folder: folder.value.trim() }));
          }}
        >
          <label>
            or as a copy in a new folder{' '}
            <input
              type="text"
              name="folder"
              placeholder="its name"
              autocomplete="off"
              value={folder}
              onInput={(event) => (folder.value = event.currentTarget.value)}
            />
          </label>{' '}
          <button type="submit" disabled={app.obstacle() !== null || folder.value.trim() === ''}>
            Save a copy
          </button>
        </form>
        {obstacle !== null && <span class="hint">{obstacle}</span>}
      </div>
    </section>
  );
}
