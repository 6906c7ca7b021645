// The page Modules is in the address, so that a reload in the middle of a job comes back to it.
import { effect } from '@preact/signals-core';
import type { Stores } from './robot_view.js';

const modulesHash = '#modules';

// Whether the fragment of the address names a page. Any other one is the token.
export function isPageHash(hash: string): boolean {
  return hash === modulesHash;
}

// Shows the page that the address names, and from then on keeps the address as the page is.
export function followPageHash({ shownPage }: Stores<'shownPage'>, hash: string, location: Location, history: History): void {
  if (isPageHash(hash)) shownPage.value = 'modules';
  let isInAddress = isPageHash(hash);
  effect(() => {
    const isShown = shownPage.value === 'modules';
    if (isShown === isInAddress) return;
    isInAddress = isShown;
    history.replaceState(null, '', location.pathname + location.search + (isShown ? modulesHash : ''));
  });
}
