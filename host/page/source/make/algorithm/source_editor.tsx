// The source that is open, in an editor that is loaded when the first one is opened.
import { useSignal, useSignalEffect } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import type { AlgorithmApp } from './algorithm_app.js';
import type { CodeEditor } from './code_mirror.js';

export function SourceEditor({ app, folder }: { app: AlgorithmApp; folder: string }) {
  const place = useRef<HTMLDivElement>(null);
  const editor = useSignal<CodeEditor | null>(null);
  const problem = useSignal<string | null>(null);
  useEffect(() => {
    let isGone = false;
    let made: CodeEditor | null = null;
    import('./code_mirror.js').then(
      ({ createEditor }) => {
        const source = app.sources.peek().get(folder);
        if (isGone || place.current === null || source === undefined) return;
        made = createEditor(place.current, {
          text: source.typed,
          label: `Source of ${source.name}`,
          onChange: (text) => app.type(folder, text),
          onSave: () => void app.save(),
        });
        editor.value = made;
      },
      (error: Error) => (problem.value = `The editor could not be loaded: ${error.message}. Reload the page.`),
    );
    return () => {
      isGone = true;
      editor.value = null;
      made?.destroy();
    };
  }, [folder]);
  // Another text, that was read from the disk.
  useSignalEffect(() => {
    const source = app.sources.value.get(folder);
    if (source !== undefined) editor.value?.setText(source.typed);
  });
  useSignalEffect(() => {
    const build = app.build.value;
    const file = app.source.peek()?.file;
    // The lines are those of the text that was built.
    if (build !== null && build.version === app.source.peek()?.version && !app.isChanged.peek()) {
      editor.value?.show(build.messages.filter((message) => message.file === file));
    }
  });
  useSignalEffect(() => {
    const to = app.place.value;
    if (to !== null) editor.value?.goTo(to.line, to.column);
  });
  return (
    <>
      <div class="code" ref={place} data-testid="code" />
      {editor.value === null && <p class="wait">{problem.value ?? 'Loading the editor …'}</p>}
      <p class="hint">Ctrl + S saves. Tab indents; Ctrl + M, or Escape (which is STOP, too), then Tab leaves the editor.</p>
    </>
  );
}
