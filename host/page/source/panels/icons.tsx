// Icons as inline SVG: strokes in the colour of the text.
import type { ComponentChildren } from 'preact';

function icon(children: ComponentChildren) {
  return (
    <svg class="icon" viewBox="0 0 16 16" aria-hidden="true" focusable="false">
      {children}
    </svg>
  );
}

export const runIcon = icon(<path d="M4 2.5v11l9-5.5z" fill="currentColor" stroke="none" />);
export const pauseIcon = icon(<path d="M4 2.5h3v11H4zM9 2.5h3v11H9z" fill="currentColor" stroke="none" />);
export const powerIcon = icon(<path d="M8 2v6M4.6 4.2a5 5 0 1 0 6.8 0" />);
export const stepIcon = icon(<path d="M3 2.5v11l7-5.5zM11 2.5h2v11h-2z" fill="currentColor" stroke="none" />);
export const restartIcon = icon(<path d="M3 3v4h4M3.5 7A5 5 0 1 1 3 9.5" />);
export const recordIcon = icon(<circle cx="8" cy="8" r="5" fill="currentColor" stroke="none" />);
export const undoIcon = icon(<path d="M6 3 3 6l3 3M3 6h6a4 4 0 0 1 0 8H6" />);
export const redoIcon = icon(<path d="m10 3 3 3-3 3M13 6H7a4 4 0 0 0 0 8h3" />);
export const swapIcon = icon(<path d="M3 5h9l-3-3M13 11H4l3 3" />);
export const closeIcon = icon(<path d="m4 4 8 8M12 4l-8 8" />);
export const themeIcon = icon(
  <>
    <circle cx="8" cy="8" r="5.5" />
    <path d="M8 2.5a5.5 5.5 0 0 1 0 11z" fill="currentColor" stroke="none" />
  </>,
);
export const findIcon = icon(
  <>
    <circle cx="7" cy="7" r="4.2" />
    <path d="m10.2 10.2 3.3 3.3" />
  </>,
);
export const documentationIcon = icon(<path d="M8 4.5C6.5 3 4 2.8 2 3v9.5c2-.2 4.5 0 6 1.5 1.5-1.5 4-1.7 6-1.5V3c-2-.2-4.5 0-6 1.5zM8 4.5V14" />);
export const addIcon = icon(<path d="M8 3v10M3 8h10" />);
export const copyIcon = icon(<path d="M6 5.5h7v8H6zM10 5.5v-3H3v8h3" />);
