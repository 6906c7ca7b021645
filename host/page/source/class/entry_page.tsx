// The way into a class: name, code, Go.
import { useLayoutEffect, useRef } from 'preact/hooks';
import { closeIcon } from '../panels/icons.js';
import { ThemeButton } from '../panels/page_tools.js';
import type { EntryState } from './entry_state.js';
import { mostNameCharacters, type JoinProblem } from './join.js';

function Problem({ field, problem }: { field: JoinProblem['field']; problem: JoinProblem | null }) {
  return (
    <p class="entry-problem" id={`problem-${field}`} role="alert">
      {problem?.field === field ? problem.text : ''}
    </p>
  );
}

// Robots of people who have been here before: one press.
function KnownNames({ entry }: { entry: EntryState }) {
  if (entry.known.value.length === 0) return null;
  return (
    <section class="known-names" aria-label="Go on">
      {entry.known.value.map((name) => (
        <span key={name} class="known-name">
          <button type="button" class="primary" disabled={entry.isBusy.value} title={name} onClick={() => void entry.goOn(name)}>
            <span>Go on as {name}</span>
          </button>
          <button
            type="button"
            class="icon-button"
            disabled={entry.isBusy.value}
            aria-label={`Forget ${name} on this computer`}
            title={`Forget ${name} on this computer`}
            onClick={() => entry.forget(name)}
          >
            {closeIcon}
          </button>
        </span>
      ))}
      <h2>Somebody else</h2>
    </section>
  );
}

export function EntryPage({ entry }: { entry: EntryState }) {
  const nameField = useRef<HTMLInputElement>(null);
  const codeField = useRef<HTMLInputElement>(null);
  const problem = entry.problem.value;
  const isBusy = entry.isBusy.value;
  useLayoutEffect(() => {
    if (entry.known.value.length === 0) nameField.current?.focus();
  }, []);
  useLayoutEffect(() => {
    const field = { name: nameField, code: codeField, button: null }[problem?.field ?? 'button'];
    field?.current?.focus();
  }, [problem]);
  return (
    <main class="entry">
      <div class="entry-tools">
        <ThemeButton />
      </div>
      <h1>Join the class</h1>
      <p class="hint">You get a robot of your own.</p>
      <KnownNames entry={entry} />
      <form
        noValidate
        onSubmit={(event) => {
          event.preventDefault();
          void entry.submit();
        }}
      >
        <label for="entry-name">Your name</label>
        <input
          ref={nameField}
          id="entry-name"
          type="text"
          autoComplete="off"
          spellcheck={false}
          maxLength={mostNameCharacters}
          aria-invalid={problem?.field === 'name'}
          aria-describedby="problem-name"
          disabled={isBusy}
          value={entry.name.value}
          onInput={(event) => (entry.name.value = event.currentTarget.value)}
        />
        <Problem field="name" problem={problem} />
        {entry.codeOfLink === null || problem?.field === 'code' ? (
          <>
            <label for="entry-code">
              Code <span class="hint">six digits, your teacher shows them</span>
            </label>
            <input
              ref={codeField}
              id="entry-code"
              type="text"
              inputMode="numeric"
              autoComplete="off"
              aria-invalid={problem?.field === 'code'}
              aria-describedby="problem-code"
              disabled={isBusy}
              value={entry.code.value}
              onInput={(event) => (entry.code.value = event.currentTarget.value)}
            />
            <Problem field="code" problem={problem} />
          </>
        ) : null}
        <button type="submit" class="primary go" disabled={isBusy} aria-busy={isBusy}>
          {isBusy ? 'Your robot starts …' : 'Go'}
        </button>
        <Problem field="button" problem={problem} />
      </form>
      <p class="hint entry-teacher">
        For the teacher: open the address that <code>proleg ui</code> prints after “teacher:”.
      </p>
    </main>
  );
}
