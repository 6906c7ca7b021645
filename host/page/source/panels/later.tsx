// Parts of the page that are loaded when they are needed.
import { signal, type Signal } from '@preact/signals';
import type { ComponentType } from 'preact';
import type { PageApp } from '../page_app.js';

type Part = ComponentType<{ app: PageApp }>;

// A component that is loaded later; null until then, a text if it cannot be loaded. It is loaded once.
export type Later = Signal<Part | string | null>;

export function loadLater(loading: Promise<Part>): Later {
  const part: Later = signal(null);
  loading.then(
    (loaded) => (part.value = loaded),
    (error: Error) => (part.value = `This part of the page could not be loaded: ${error.message}. Reload the page.`),
  );
  return part;
}

export function LaterView({ app, part, wait }: { app: PageApp; part: Later; wait: string }) {
  const Content = part.value;
  return Content === null || typeof Content === 'string' ? <p class="wait">{Content ?? wait}</p> : <Content app={app} />;
}
