// What does not fit the window.
import assert from 'node:assert/strict';
import type { Viewer } from './viewer.js';
import { waitUntil } from './waiting.js';

// The page, if it is wider than the window; texts and controls that are cut, where nothing can be scrolled to see them.
function whatIsCut(): string[] {
  const name = (element: Element) => `${element.tagName.toLowerCase()}.${element.className} '${(element.textContent ?? '').trim().slice(0, 40)}'`;
  const root = document.documentElement;
  const cut = root.scrollWidth > root.clientWidth ? [`the page: ${root.scrollWidth} pixels in ${root.clientWidth}`] : [];
  const scrolls = (style: CSSStyleDeclaration) => ['auto', 'scroll'].includes(style.overflowX);
  for (const element of document.querySelectorAll<HTMLElement>('body *')) {
    const hasText = [...element.childNodes].some((node) => node.nodeType === Node.TEXT_NODE && node.textContent?.trim());
    const box = element.getBoundingClientRect();
    // What is only for screen readers has a pixel.
    if ((!hasText && !element.matches('input, select, button')) || box.width <= 1 || !element.checkVisibility({ visibilityProperty: true })) continue;
    let canBeSeen = false;
    for (let parent: HTMLElement | null = element; parent !== null; parent = parent.parentElement) {
      canBeSeen ||= scrolls(getComputedStyle(parent));
    }
    const style = getComputedStyle(element);
    const isShortened = style.overflowX === 'hidden' && element.scrollWidth > element.clientWidth + 1 && !element.closest('[title]');
    if (!canBeSeen && (box.left < -1 || box.right > innerWidth + 1 || isShortened)) cut.push(name(element));
  }
  return cut;
}

// Waits: a canvas follows the window with the next frames.
export async function assertNothingIsCut(viewer: Viewer): Promise<void> {
  let cut: string[] = [];
  await waitUntil(async () => (cut = await viewer.page.evaluate(whatIsCut)).length === 0);
  assert.deepEqual(cut, []);
}
