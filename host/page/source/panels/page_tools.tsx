// The buttons at the end of every bar: find an action, show the keys, change the colours.
import type { ComponentChildren } from 'preact';
import { toggleDialog } from '../view/dialogs.js';
import { nextTheme, themeChoice } from '../view/theme.js';
import { findIcon, themeIcon } from './icons.js';

// `hint`: the key, if the page has one.
export function ThemeButton({ hint = '' }: { hint?: string }) {
  return (
    <button
      type="button"
      class="icon-button"
      aria-label={`Colours: ${themeChoice.value}`}
      title={`Colours: ${themeChoice.value}${hint}`}
      onClick={nextTheme}
    >
      {themeIcon}
    </button>
  );
}

// `documentation`: the link to it, if there is one.
export function PageTools({ documentation = null }: { documentation?: ComponentChildren }) {
  return (
    <div class="tools">
      {documentation}
      <button
        type="button"
        class="icon-button"
        aria-label="Find an action"
        title="Find an action (Ctrl+K)"
        onClick={() => toggleDialog('palette')}
      >
        {findIcon}
      </button>
      <button
        type="button"
        class="icon-button"
        aria-label="Show the keys"
        title="Show the keys (?)"
        onClick={() => toggleDialog('keys')}
      >
        ?
      </button>
      <ThemeButton hint=" (T)" />
    </div>
  );
}
