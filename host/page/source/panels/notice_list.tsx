// The last notices, for some seconds each; errors stay until they are closed.
import { signal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import type { Notice } from '../state/page_state.js';
import { openDialog } from '../view/dialogs.js';
import type { Stores } from '../view/robot_view.js';
import { closeIcon } from './icons.js';

const shownFor = 8000; // milliseconds
const mostShown = 4;

const closed = signal<ReadonlySet<number>>(new Set());

function close(number: number): void {
  closed.value = new Set([...closed.value, number]);
}

function NoticeView({ notice }: { notice: Notice }) {
  useEffect(() => {
    if (notice.level === 'error') {
      return undefined;
    }
    // It counts from when it is first seen, also while newer ones or another page hide it.
    setTimeout(() => close(notice.number), shownFor);
    return undefined;
  }, [notice.number]);
  return (
    <li class={`notice ${notice.level}`}>
      <span>{notice.text}</span>
      <button type="button" class="icon-button" aria-label="Close this notice" onClick={() => close(notice.number)}>
        {closeIcon}
      </button>
    </li>
  );
}

export function NoticeList({ app: { shownPage, state } }: { app: Stores<'shownPage' | 'state'> }) {
  const isLiveInFront = (shownPage.value !== 'recordings' || state.isAlone.value) && openDialog.value === 'none';
  const shown = state.noticesFor(isLiveInFront).filter((notice) => !closed.value.has(notice.number)).slice(-mostShown);
  return (
    <ul class="notices" aria-live="polite" aria-label="Notices">
      {shown.map((notice) => (
        <NoticeView key={notice.number} notice={notice} />
      ))}
    </ul>
  );
}
