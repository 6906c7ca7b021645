// The fragment of the address: a token, a page, or `TOKEN&PAGE`. The page Modules stays in the address, so that a reload in the
// middle of a job comes back to it.
import { effect } from '@preact/signals-core';
import type { PageName, Stores } from './robot_view.js';

const modulesHash = '#modules';

// The pages that an address may name.
const names: readonly PageName[] = ['recordings', 'modules'];

export interface PageHash {
  token: string; // empty: none
  page: PageName | null;
}

export function readPageHash(hash: string): PageHash {
  const [first = '', second] = hash.replace(/^#/, '').split('&');
  const page = names.find((name) => name === (second ?? first)) ?? null;
  return { token: page !== null && second === undefined ? '' : first, page };
}

// Shows the page that the address names, and from then on keeps the address as the page is.
export function followPageHash({ shownPage }: Stores<'shownPage'>, { page }: PageHash, location: Location, history: History): void {
  if (page !== null) shownPage.value = page;
  let isInAddress = location.hash === modulesHash;
  if (location.hash !== '' && !isInAddress) history.replaceState(null, '', location.pathname + location.search);
  effect(() => {
    const isShown = shownPage.value === 'modules';
    if (isShown === isInAddress) return;
    isInAddress = isShown;
    history.replaceState(null, '', location.pathname + location.search + (isShown ? modulesHash : ''));
  });
}
