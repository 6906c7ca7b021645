// Parts of the page that are loaded after the first paint, or when they are shown first.
import { signal, type Signal } from '@preact/signals';
import type { ComponentType } from 'preact';
import type { PageApp } from '../page_app.js';

type Part = ComponentType<{ app: PageApp }>;

// A component; null until it is loaded, a text if it cannot be loaded.
type Later = Signal<Part | string | null>;

// Loads the component at the first call of the result, once.
export function loadLater(load: () => Promise<Part>): () => Later {
  let part: Later | null = null;
  const begin = () => {
    const loading: Later = signal(null);
    load().then(
      (loaded) => (loading.value = loaded),
      (error: Error) => (loading.value = `This part of the page could not be loaded: ${error.message}. Reload the page.`),
    );
    return loading;
  };
  return () => (part ??= begin());
}

export function LaterView({ app, part, wait }: { app: PageApp; part: Later; wait: string }) {
  const Content = part.value;
  return Content === null || typeof Content === 'string' ? <p class="wait">{Content ?? wait}</p> : <Content app={app} />;
}
