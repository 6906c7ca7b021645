// The editor of a source: CodeMirror in a shadow root, because there it takes its styles from style sheet objects, which the
// content security policy of the page allows; elsewhere it would write a <style> element.
import { defaultKeymap, history, historyKeymap, indentWithTab, toggleTabFocusMode } from '@codemirror/commands';
import { cpp } from '@codemirror/lang-cpp';
import { bracketMatching, HighlightStyle, indentOnInput, indentUnit, syntaxHighlighting } from '@codemirror/language';
import { lintGutter, lintKeymap, setDiagnostics, type Diagnostic } from '@codemirror/lint';
import { EditorState, type Text } from '@codemirror/state';
import { drawSelection, EditorView, highlightActiveLine, highlightActiveLineGutter, keymap, lineNumbers } from '@codemirror/view';
import { tags } from '@lezer/highlight';
import type { BuildMessage } from '../../wire/messages.js';

export interface CodeEditor {
  readonly text: string;
  setText(text: string): void;
  // Marks the places of messages, which follow the text that is typed from then on.
  show(messages: readonly BuildMessage[]): void;
  goTo(line: number, column: number): void;
  destroy(): void;
}

// Colours of the page, in both themes.
const theme = EditorView.theme({
  '&': { color: 'var(--text)', backgroundColor: 'var(--surface)', height: '100%', fontSize: '13px' },
  '&.cm-focused': { outline: '3px solid var(--focus)', outlineOffset: '-3px' },
  '.cm-scroller': { fontFamily: "ui-monospace, 'DejaVu Sans Mono', monospace", lineHeight: '1.45' },
  '.cm-content': { caretColor: 'var(--text)' },
  '.cm-cursor': { borderLeftColor: 'var(--text)' },
  '.cm-gutters': { backgroundColor: 'var(--raised)', color: 'var(--quiet)', borderRight: '1px solid var(--line)' },
  '.cm-activeLine, .cm-activeLineGutter': { backgroundColor: 'color-mix(in srgb, var(--accent) 9%, transparent)' },
  '&.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground, .cm-selectionBackground': {
    backgroundColor: 'color-mix(in srgb, var(--accent) 28%, transparent)',
  },
  '.cm-tooltip': { backgroundColor: 'var(--raised)', color: 'var(--text)', border: '1px solid var(--line)' },
  '.cm-panels': { backgroundColor: 'var(--raised)', color: 'var(--text)' },
});

const colours = HighlightStyle.define([
  { tag: [tags.keyword, tags.modifier, tags.operatorKeyword, tags.processingInstruction], color: 'var(--path)' },
  { tag: [tags.typeName, tags.namespace, tags.className], color: 'var(--accent)' },
  { tag: [tags.string, tags.character], color: 'var(--good)' },
  { tag: [tags.number, tags.bool], color: 'var(--changed)' },
  { tag: tags.comment, color: 'var(--quiet)', fontStyle: 'italic' },
]);

const severities = { error: 'error', warning: 'warning', note: 'info' } as const;

// Compilers count bytes; a line has other characters than ASCII in comments only.
function position(text: Text, line: number, column: number): number {
  const { from, to } = text.line(Math.min(Math.max(line, 1), text.lines));
  return Math.min(from + Math.max(column - 1, 0), to);
}

function diagnosticOf(state: EditorState, { line, column, severity, text: message }: BuildMessage): Diagnostic {
  const from = position(state.doc, line, column);
  const word = state.wordAt(from);
  return { from, to: word?.to ?? from, severity: severities[severity], message };
}

export function createEditor(parent: HTMLElement, options: {
  text: string;
  label: string;
  onChange(text: string): void;
  onSave(): void;
}): CodeEditor {
  const root = parent.shadowRoot ?? parent.attachShadow({ mode: 'open' });
  let isOwnChange = false;
  const state = (text: string) =>
    EditorState.create({
      doc: text,
      extensions: [
        lineNumbers(),
        lintGutter(),
        history(),
        drawSelection(),
        indentOnInput(),
        indentUnit.of('  '),
        bracketMatching(),
        highlightActiveLine(),
        highlightActiveLineGutter(),
        cpp(),
        syntaxHighlighting(colours),
        theme,
        EditorView.contentAttributes.of({ 'aria-label': options.label, spellcheck: 'false', tabindex: '0' }),
        keymap.of([
          { key: 'Mod-s', preventDefault: true, run: () => (options.onSave(), true) },
          { key: 'Ctrl-m', run: toggleTabFocusMode },
          indentWithTab,
          ...lintKeymap,
          ...historyKeymap,
          ...defaultKeymap,
        ]),
        EditorView.updateListener.of((update) => {
          if (update.docChanged && !isOwnChange) options.onChange(update.state.doc.toString());
        }),
      ],
    });
  const view = new EditorView({ state: state(options.text), parent: root, root });
  // Escape is STOP on the whole page, so that the editor does not get it: after it, Tab leaves the editor.
  const onEscape = (event: KeyboardEvent) => {
    const timeToLeave = 2000; // ms
    if (event.key === 'Escape' && view.hasFocus) view.setTabFocusMode(timeToLeave);
  };
  window.addEventListener('keydown', onEscape, { capture: true });
  return {
    get text() {
      return view.state.doc.toString();
    },
    setText(text) {
      if (view.state.doc.toString() === text) return;
      isOwnChange = true;
      view.setState(state(text));
      isOwnChange = false;
    },
    show(messages) {
      const placed = messages.filter(({ line }) => line > 0).map((message) => diagnosticOf(view.state, message));
      view.dispatch(setDiagnostics(view.state, placed));
    },
    goTo(line, column) {
      const at = position(view.state.doc, line, column);
      view.dispatch({ selection: { anchor: at }, effects: EditorView.scrollIntoView(at, { y: 'center' }) });
      view.focus();
    },
    destroy() {
      window.removeEventListener('keydown', onEscape, { capture: true });
      view.destroy();
    },
  };
}
