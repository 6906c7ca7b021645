// Keys of the whole page. Space (STOP) and Esc have priority, whichever element has the focus, if the page has a robot.
import type { ActionList } from '../state/actions.js';

const textInputs = new Set(['text', 'number', 'search']);

export function isTextField(target: EventTarget | null): boolean {
  return (
    target instanceof HTMLTextAreaElement ||
    (target instanceof HTMLInputElement && textInputs.has(target.type)) ||
    (target instanceof HTMLElement && target.isContentEditable)
  );
}

// The element that has the focus, also in a shadow root.
function targetOf(event: KeyboardEvent): EventTarget | null {
  return event.composedPath()[0] ?? event.target;
}

// Elements that use the arrow keys themselves.
function usesArrows(target: EventTarget | null): boolean {
  return target instanceof Element && target.closest('input, select, [role="slider"], [data-arrows]') !== null;
}

// Elements in which a number can be typed at once.
function takesNumber(target: EventTarget | null): boolean {
  return target instanceof Element && target.closest('[data-takes-number]') !== null;
}

// What the keys with priority do.
interface RobotKeys {
  space(): void; // outside text fields
  escape(): void;
}

// `robotKeys`: null: the page has no robot, these keys are as all others.
export function listenToKeys(actions: Pick<ActionList, 'forKey'>, robotKeys: RobotKeys | null): void {
  window.addEventListener(
    'keydown',
    (event) => {
      const isText = isTextField(targetOf(event));
      if (robotKeys !== null && (event.key === 'Escape' || (event.key === ' ' && !isText))) {
        // A key that is held down counts as one press.
        if (!event.repeat) robotKeys[event.key === ' ' ? 'space' : 'escape']();
        event.preventDefault();
        event.stopPropagation();
        return;
      }
      const action = actions.forKey(event, isText);
      const isOfElement = (event.key.startsWith('Arrow') && usesArrows(event.target)) || (/^[0-9.,+-]$/.test(event.key) && takesNumber(event.target));
      if (isOfElement && action?.isBeforeElements !== true) {
        return;
      }
      if (action !== undefined) {
        event.preventDefault();
        if (action.isBeforeElements === true) event.stopPropagation();
        action.run();
      }
    },
    { capture: true },
  );
  // Buttons act on the release of Space; here Space is an action of the page.
  window.addEventListener(
    'keyup',
    (event) => {
      if (event.key === ' ' && !isTextField(targetOf(event))) event.preventDefault();
    },
    { capture: true },
  );
}
