// Actions that every page has, live or of a recording.
import { toggleDialog } from './dialogs.js';
import type { Action } from '../state/actions.js';
import { nextTheme } from './theme.js';

export const sharedActions: readonly Action[] = [
  {
    id: 'palette',
    title: 'Find an action',
    group: 'Page',
    keys: ['Ctrl+K'],
    isGlobal: true,
    run: () => toggleDialog('palette'),
  },
  { id: 'keys', title: 'Show the keys', group: 'Page', keys: ['?'], run: () => toggleDialog('keys') },
  { id: 'theme', title: 'Light, dark, or as the system', group: 'Page', keys: ['T'], run: nextTheme },
];
