// Parts of the page that are loaded after the first paint, or when they are shown first.
import { signal, type Signal } from '@preact/signals';
import type { ComponentType } from 'preact';

type Part<App> = ComponentType<{ app: App }>;

// A component; null until it is loaded, a text if it cannot be loaded.
export type Later<App> = Signal<Part<App> | string | null>;

// Loads the component at the first call of the result, once.
export function loadLater<App>(load: () => Promise<Part<App>>): () => Later<App> {
  let part: Later<App> | null = null;
  const begin = () => {
    const loading: Later<App> = signal(null);
    load().then(
      (loaded) => (loading.value = loaded),
      (error: Error) => (loading.value = `This part of the page could not be loaded: ${error.message}. Reload the page.`),
    );
    return loading;
  };
  return () => (part ??= begin());
}

// Loads parts that were not needed yet while the browser has nothing else to do, so that they open without a wait.
export function loadWhenIdle(parts: (() => unknown)[]): void {
  const [next, ...others] = parts;
  if (next === undefined) return;
  const load = () => {
    next();
    loadWhenIdle(others);
  };
  if (typeof requestIdleCallback === 'function') requestIdleCallback(load);
  else setTimeout(load, 1000);
}

export function LaterView<App>({ app, part, wait }: { app: App; part: Later<App>; wait: string }) {
  const Content = part.value;
  return Content === null || typeof Content === 'string' ? <p class="wait">{Content ?? wait}</p> : <Content app={app} />;
}
