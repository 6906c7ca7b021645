// The dialog that is open.
import { signal } from '@preact/signals-core';

export type Dialog = 'none' | 'keys' | 'palette' | 'command_line' | 'file_diff' | 'value_table' | 'joint_table' | 'class';

export const openDialog = signal<Dialog>('none');

export function toggleDialog(dialog: Dialog): void {
  openDialog.value = openDialog.value === dialog ? 'none' : dialog;
}
