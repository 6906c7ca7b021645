// The frame of the page: top bar, bands, notices, dialogs; the page below it comes later.
import type { ComponentType } from 'preact';
import { useEffect, useState } from 'preact/hooks';
import type { PageApp } from '../page_app.js';
import { openDialog } from '../dialogs.js';
import { Bands } from './bands.js';
import { NoticeList } from './notice_list.js';
import { TopBar } from './top_bar.js';

type Part = ComponentType<{ app: PageApp }>;

// A component that is loaded after the first paint; null until then, a text if it cannot be loaded.
function useLater(load: () => Promise<Part>): Part | string | null {
  const [part, setPart] = useState<Part | string | null>(null);
  useEffect(() => {
    load().then(
      (loaded) => setPart(() => loaded),
      (error: Error) => setPart(`This part of the page could not be loaded: ${error.message}. Reload the page.`),
    );
  }, []);
  return part;
}

function Later({ app, load, wait }: { app: PageApp; load: () => Promise<Part>; wait: string }) {
  const Content = useLater(load);
  return Content === null || typeof Content === 'string' ? <p class="wait">{Content ?? wait}</p> : <Content app={app} />;
}

const loadLivePage = () => import('./live_page.js').then((module) => module.LivePage);
const loadDialogs = () => import('./dialog_views.js').then((module) => module.DialogView);

export function Frame({ app }: { app: PageApp }) {
  return (
    <>
      <TopBar app={app} />
      <Bands app={app} />
      <main id="page">
        <Later app={app} load={loadLivePage} wait="Loading …" />
      </main>
      <NoticeList state={app.state} />
      {openDialog.value !== 'none' && <Later app={app} load={loadDialogs} wait="" />}
    </>
  );
}
