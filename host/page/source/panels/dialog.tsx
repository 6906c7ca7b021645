// The frame of a dialog. Dialogs are not modal: STOP must stay within reach, by mouse too. They close with their key, their
// button, or a click beside them. For a robot on a bus Esc is STOP in them as everywhere; in a simulation it closes them.
import type { ComponentChildren } from 'preact';
import { useLayoutEffect, useRef } from 'preact/hooks';
import { openDialog } from '../view/dialogs.js';
import { closeIcon } from './icons.js';

export function close(): void {
  openDialog.value = 'none';
}

export function Dialog({ title, isWide, children }: { title: string; isWide?: boolean; children: ComponentChildren }) {
  const dialog = useRef<HTMLDivElement>(null);
  // Before the next key, which else would be one of the page.
  useLayoutEffect(() => {
    const before = document.activeElement;
    const find = (tag: string) => dialog.current?.querySelector<HTMLElement>(tag);
    (find('input:not([tabindex="-1"])') ?? find('button'))?.focus();
    return () => {
      if (before instanceof HTMLElement) before.focus();
    };
  }, []);
  return (
    <>
    <div class="backdrop" onClick={close} />
    <div ref={dialog} class={isWide === true ? 'dialog wide-dialog' : 'dialog'} role="dialog" aria-label={title}>
      <div class="dialog-head">
        <h2>{title}</h2>
        <button type="button" class="icon-button" aria-label="Close" onClick={close}>
          {closeIcon}
        </button>
      </div>
      {children}
    </div>
    </>
  );
}
