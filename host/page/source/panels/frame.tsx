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
const loadRecordings = () => loadLater(import('../recordings/recordings_page.js').then((module) => module.RecordingsPage));
let recordingsPage: Later | null = null; // loaded when it is first shown
const dialogs = loadLater(import('./dialog_views.js').then((module) => module.DialogView));

function LaterView({ app, part, wait }: { app: PageApp; part: Later; wait: string }) {
  const Content = part.value;
  return Content === null || typeof Content === 'string' ? <p class="wait">{Content ?? wait}</p> : <Content app={app} />;
}

// A page stays when another one is shown.
export function Frame({ app }: { app: PageApp }) {
  const page = app.shownPage.value;
  const isAlone = app.state.recordings.value?.alone === true;
  if (page === 'recordings') {
    recordingsPage ??= loadRecordings();
  }
  return (
    <>
      <TopBar app={app} />
      <Bands app={app} />
      <main id="page">
        {!isAlone && (
          <div hidden={page !== 'live'}>
            <LaterView app={app} part={livePage} wait="Loading …" />
          </div>
        )}
        {recordingsPage !== null && (
          <div hidden={page !== 'recordings'}>
            <LaterView app={app} part={recordingsPage} wait="Loading …" />
          </div>
        )}
      </main>
      <NoticeList state={app.state} />
      {openDialog.value !== 'none' && <LaterView app={app} part={dialogs} wait="" />}
    </>
  );
}
