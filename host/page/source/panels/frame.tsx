// The frame of the page: top bar, bands, notices, dialogs; the page below it comes later.
import { signal, type Signal } from '@preact/signals';
import type { ComponentType } from 'preact';
import type { PageApp } from '../page_app.js';
import { openDialog } from '../dialogs.js';
import { Bands } from './bands.js';
import { NoticeList } from './notice_list.js';
import { TopBar } from './top_bar.js';

type Part = ComponentType<{ app: PageApp }>;

// A component that is loaded after the first paint; null until then, a text if it cannot be loaded. It is loaded once.
type Later = Signal<Part | string | null>;

function loadLater(loading: Promise<Part>): Later {
  const part: Later = signal(null);
  loading.then(
    (loaded) => (part.value = loaded),
    (error: Error) => (part.value = `This part of the page could not be loaded: ${error.message}. Reload the page.`),
  );
  return part;
}

const livePage = loadLater(import('./live_page.js').then((module) => module.LivePage));
const dialogs = loadLater(import('./dialog_views.js').then((module) => module.DialogView));

function LaterView({ app, part, wait }: { app: PageApp; part: Later; wait: string }) {
  const Content = part.value;
  return Content === null || typeof Content === 'string' ? <p class="wait">{Content ?? wait}</p> : <Content app={app} />;
}

export function Frame({ app }: { app: PageApp }) {
  return (
    <>
      <TopBar app={app} />
      <Bands app={app} />
      <main id="page">
        <LaterView app={app} part={livePage} wait="Loading …" />
      </main>
      <NoticeList state={app.state} />
      {openDialog.value !== 'none' && <LaterView app={app} part={dialogs} wait="" />}
    </>
  );
}
