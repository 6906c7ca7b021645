// A link to the documentation, which opens in another tab. There is none if the program has no documentation.
import type { ComponentChildren } from 'preact';
import type { PageState } from '../state/page_state.js';

// Where the server has it (docs/page-interface.md).
const documentation = '/docs/';

interface Properties {
  state: PageState;
  to: string; // a page of it, such as "flashing.html#an-empty-chip"
  isButton?: boolean;
  label?: string; // if the content is a picture
  children: ComponentChildren;
}

export function DocumentationLink({ state, to, isButton = false, label, children }: Properties) {
  if (state.program.value?.has_documentation !== true) return null;
  return (
    <a class={isButton ? 'icon-button' : ''} href={`${documentation}${to}`} target="_blank" rel="noopener" aria-label={label} title={label === undefined ? 'In another tab' : `${label}, in another tab`}>
      {children}
    </a>
  );
}
