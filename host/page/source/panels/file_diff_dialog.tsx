// The dialog with the differences between the wanted parameters and the file, line by line, from which the user chooses.
import { useSignal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import type { Stores } from '../view/robot_view.js';
import { chosenNumbers, groupByFile, jointsText, keyOf } from '../state/file_diff.js';
import type { FileDiff, FileDiffEntry } from '../wire/messages.js';
import { close, Dialog } from './dialog.js';

function Entry({ app, entry, isChosen, toggle }: { app: Stores<'state'>; entry: FileDiffEntry; isChosen: boolean; toggle: () => void }) {
  const robot = app.state.robot.value;
  const names = robot?.joints.map((joint) => joint.name) ?? [];
  const group = robot?.slots.find((slot) => slot.number === entry.slot)?.joints ?? [];
  return (
    <li>
      <label>
        <input
          type="checkbox"
          checked={isChosen}
          onChange={toggle}
          onKeyDown={(event) => {
            if (event.key === 'Enter') toggle(); // Space is STOP
          }}
        />
        {entry.name.replace(/_/g, ' ')} of {jointsText(entry, names, group)}
        <span class="hint">{entry.old === null ? `new, after line ${entry.line}` : `line ${entry.line}`}</span>
      </label>
      <div class="diff-lines">
        {entry.old !== null && <del>{entry.old}</del>}
        <ins>{entry.new}</ins>
      </div>
    </li>
  );
}

// Copies all files of the robot, with the wanted values, into a new folder.
function SaveAs({ app, isHolder }: { app: Stores<'operations' | 'state'>; isHolder: boolean }) {
  const folder = useSignal('');
  const problem = useSignal<string | null>(null);
  const save = () => {
    app.operations.ask('file.save_as', { folder: folder.value.trim() }).then(close, (error: Error) => {
      problem.value = error.message;
    });
  };
  return (
    <form
      class="save-as"
      onSubmit={(event) => {
        event.preventDefault();
        save();
      }}
    >
      <label>
        Save as{' '}
        <input
          name="folder"
          value={folder}
          placeholder="name of a new folder"
          autocomplete="off"
          onInput={(event) => (folder.value = event.currentTarget.value)}
        />
      </label>{' '}
      <button type="submit" disabled={!isHolder || folder.value.trim() === ''}>
        Save a copy
      </button>{' '}
      <span class="hint">All files of the robot with all values as they are now, in a folder beside the recordings.</span>
      {problem.value !== null && (
        <p class="problem" role="alert">
          {problem.value}
        </p>
      )}
    </form>
  );
}

export function FileDiffDialog({ app }: { app: Stores<'operations' | 'state'> }) {
  const diff = useSignal<FileDiff | null>(null);
  const problem = useSignal<string | null>(null);
  const leftOut = useSignal<ReadonlySet<string>>(new Set());
  const parameters = app.state.parameters.value;
  const isHolder = app.state.isHolder.value;

  useEffect(() => {
    app.operations.ask('file.diff', {}).then(
      (value) => (diff.value = value as FileDiff),
      (error: Error) => (problem.value = error.message),
    );
  }, [parameters]);

  const choose = (keys: readonly string[], isChosen: boolean) => {
    const kept = [...leftOut.value].filter((key) => !keys.includes(key));
    leftOut.value = new Set(isChosen ? kept : [...kept, ...keys]);
  };
  const chosen = diff.value === null ? [] : chosenNumbers(diff.value, leftOut.value);
  const apply = () => {
    app.operations.ask('file.apply', { diff: diff.value?.diff ?? '', entries: chosen }).then(close, (error: Error) => {
      problem.value = error.message;
    });
  };
  const entries = diff.value?.entries ?? [];
  const isShipped = diff.value?.is_shipped ?? false;
  const hint = !isHolder
    ? 'Writing needs control.'
    : isShipped
      ? 'These files ship with Proleg and stay as they are. Save a copy, and go on with that.'
      : 'Enter switches a line on or off. Everything else in the file stays.';

  return (
    <Dialog title="Apply to file" isWide>
      {diff.value === null && problem.value === null && <p class="hint">Asking the program …</p>}
      {diff.value !== null && entries.length === 0 && <p class="hint">The file has the wanted values.</p>}
      <div class="diff" data-testid="diff">
        {groupByFile(entries).map(({ file, numbers }) => {
          const keys = numbers.map((i) => keyOf(entries[i] as FileDiffEntry));
          return (
            <section key={file} aria-label={file}>
              <h3>{file}</h3>
              <p>
                <button type="button" onClick={() => choose(keys, true)}>
                  All
                </button>{' '}
                <button type="button" onClick={() => choose(keys, false)}>
                  None
                </button>
              </p>
              <ul>
                {numbers.map((i) => {
                  const entry = entries[i] as FileDiffEntry;
                  const isChosen = chosen.includes(i);
                  return (
                    <Entry
                      key={keyOf(entry)}
                      app={app}
                      entry={entry}
                      isChosen={isChosen}
                      toggle={() => choose([keyOf(entry)], !isChosen)}
                    />
                  );
                })}
              </ul>
            </section>
          );
        })}
      </div>
      {problem.value !== null && (
        <p class="problem" role="alert">
          {problem.value}
        </p>
      )}
      <button type="button" class="primary" disabled={!isHolder || isShipped || chosen.length === 0} onClick={apply}>
        {chosen.length === 1 ? 'Write 1 change' : `Write ${chosen.length} changes`}
      </button>{' '}
      <span class="hint">{hint}</span>
      {(diff.value !== null || problem.value !== null) && <SaveAs app={app} isHolder={isHolder} />}
    </Dialog>
  );
}
