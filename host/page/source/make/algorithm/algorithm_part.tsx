// The part Algorithm of the page Make: algorithms of the user's own, written, built and run without a command line.
import { useEffect } from 'preact/hooks';
import { DocumentationLink } from '../../panels/documentation_link.js';
import type { AlgorithmBuild, BuildMessage } from '../../wire/messages.js';
import { algorithmApp, type AlgorithmApp, type AlgorithmHost } from './algorithm_app.js';
import { AlgorithmFormView } from './algorithm_form.js';
import { ImageView } from './image_view.js';
import { ProofView } from './proof_view.js';
import { SourceEditor } from './source_editor.js';

function buildText(build: AlgorithmBuild, isChanged: boolean): string {
  const errors = build.messages.filter(({ severity }) => severity === 'error').length;
  switch (build.state) {
    case 'running':
      return build.of === 0 ? 'The build begins …' : `Building: ${build.done} of ${build.of} …`;
    case 'passed':
      return isChanged ? 'Built; the source has changed since.' : 'Built and loaded: Simulate and Restart use it from now on.';
    case 'cancelled':
      return 'The build was cancelled.';
    case 'failed':
      return errors === 0 ? `The build failed: ${build.error}` : `The build failed: ${errors === 1 ? '1 error' : `${errors} errors`}.`;
  }
}

function Message({ app, message, isOwnFile }: { app: AlgorithmApp; message: BuildMessage; isOwnFile: boolean }) {
  const text = `${message.severity}: ${message.text}`;
  return (
    <li>
      {isOwnFile && message.line > 0 ? (
        <button type="button" onClick={() => (app.place.value = { line: message.line, column: message.column })}>
          line {message.line}: {text}
        </button>
      ) : (
        <span class="hint">
          {message.file === '' ? '' : `${message.file}${message.line > 0 ? `:${message.line}` : ''}: `}
          {text}
        </span>
      )}
    </li>
  );
}

function Work({ app }: { app: AlgorithmApp }) {
  const source = app.source.value;
  const build = app.build.value;
  const check = app.check.value;
  const failure = app.make.page.state.session.value?.failure ?? null;
  const library = app.make.page.state.algorithmFolders.value?.folders.find(({ folder }) => folder === source?.folder);
  if (source === null) return null;
  return (
    <>
      {build !== null && (
        <p role="status" data-testid="algorithm-build">
          {buildText(build, build.version !== source.version || app.isChanged.value)}
        </p>
      )}
      {build !== null && build.messages.length > 0 && (
        <ul class="objects" aria-label="Messages of the build">
          {build.messages.map((message, i) => (
            <Message key={i} app={app} message={message} isOwnFile={message.file === source.file} />
          ))}
        </ul>
      )}
      {failure?.includes(`'${source.name}'`) === true && (
        <p class="problem" role="alert" data-testid="algorithm-failure">
          The simulation has stopped: {failure}
        </p>
      )}
      {library?.loaded === true && (
        <p class="hint">
          A scenario names it as any other: <code>&lt;actuationModule name="{source.name}"&gt;</code>. A program that is started later loads it with{' '}
          <code>--algorithms {library.library}</code>.
        </p>
      )}
      {check !== null && <ProofView check={check} isOld={check.version !== source.version || app.isChanged.value} />}
    </>
  );
}

function SourceView({ app }: { app: AlgorithmApp }) {
  const source = app.source.value;
  const obstacle = app.obstacle();
  const work = app.work.value;
  const busy = work === null ? null : `${work.name}: wait, or cancel what goes on.`;
  if (source === null) return null;
  return (
    <>
      <div class="fields">
        <h3>{source.file}</h3>
        <span class="hint" data-testid="algorithm-state">
          {app.isChanged.value ? 'not saved' : 'saved'}
        </span>
        <button
          type="button"
          disabled={obstacle !== null || !app.isChanged.value}
          title={obstacle ?? 'Writes the file (Ctrl + S in the editor)'}
          onClick={() => void app.save()}
        >
          Save the source
        </button>
        <button
          type="button"
          class="primary"
          disabled={obstacle !== null || busy !== null}
          title={obstacle ?? busy ?? 'Saves, compiles and loads it'}
          onClick={() => void app.begin('algorithm.build')}
        >
          Build
        </button>
        <button
          type="button"
          disabled={obstacle !== null || busy !== null}
          title={obstacle ?? busy ?? 'Saves, and proves that all compilers and the modules compute the same bits'}
          onClick={() => void app.begin('algorithm.check')}
        >
          Check
        </button>
        {work !== null && !work.isImage && (
          <button type="button" disabled={obstacle !== null} onClick={() => app.cancel()}>
            Cancel {work.name}
          </button>
        )}
        {obstacle !== null && <span class="hint">{obstacle}</span>}
      </div>
      {app.problem.value !== null && (
        <p class="problem" role="alert">
          {app.problem.value}{' '}
          <button type="button" onClick={() => void app.openAgain()}>
            Open the file again
          </button>
        </p>
      )}
      <SourceEditor key={source.folder} app={app} folder={source.folder} />
      <Work app={app} />
    </>
  );
}

export function AlgorithmPart({ app: make }: { app: AlgorithmHost }) {
  const app = algorithmApp(make);
  const { state, operations } = make.page;
  const document = state.algorithmFolders.value;
  // Another program may have written algorithms meanwhile.
  useEffect(() => {
    if (document?.refusal === null) void operations.ask('algorithm.refresh', {}).catch(() => {});
  }, []);
  return (
    <section class="panel make-panel" aria-label="Algorithm">
      <h2>Algorithm</h2>
      {document === null && <p class="wait">Waiting for the program …</p>}
      {document !== null && document.refusal !== null && <p class="hint">Algorithms cannot be written here: {document.refusal}.</p>}
      {document !== null && document.refusal === null && (
        <>
          <p class="hint">A gait or a reflex of your own, in C++: a form writes the source, which you then edit, build and run here. <DocumentationLink state={state} to="user-algorithms.html">How to write one</DocumentationLink></p>
          <div class="fields" role="group" aria-label="Algorithms of your own">
            {document.folders.map(({ folder, name }) => (
              <button
                key={folder}
                type="button"
                aria-pressed={!app.isMaking.value && app.chosen.value === folder}
                onClick={() => void app.open(folder)}
              >
                {folder === name ? name : `${name} (${folder === '.' ? 'this folder' : folder})`}
              </button>
            ))}
            <button type="button" aria-pressed={app.isMaking.value} onClick={() => (app.isMaking.value = !app.isMaking.value)}>
              New algorithm …
            </button>
          </div>
          {app.isMaking.value ? <AlgorithmFormView app={app} first={document.form} /> : <SourceView app={app} />}
          {app.problem.value !== null && app.source.value === null && (
            <p class="problem" role="alert">
              {app.problem.value}
            </p>
          )}
          {!app.isMaking.value && document.folders.length > 0 && <ImageView app={app} folders={document.folders} />}
        </>
      )}
    </section>
  );
}
