// The frame of the page: top bar, bands, notices, dialogs; the page below it comes later.
import type { PageApp } from '../page_app.js';
import { openDialog } from '../dialogs.js';
import { Bands } from './bands.js';
import { LaterView, loadLater } from './later_view.js';
import { NoticeList } from './notice_list.js';
import { TopBar } from './top_bar.js';

const livePage = loadLater(() => import('./live_page.js').then((module) => module.LivePage));
// A robot on a bus has panels of its own.
const robotPage = loadLater(() => import('./bus/robot_page.js').then((module) => module.RobotPage));
const dialogs = loadLater(() => import('./dialog_views.js').then((module) => module.DialogView));
livePage();
dialogs();

export function Frame({ app }: { app: PageApp }) {
  const robot = app.state.robot.value;
  return (
    <>
      <TopBar app={app} />
      <Bands app={app} />
      <main id="page">
        {robot === null ? (
          <p class="wait">Waiting for the robot …</p>
        ) : (
          <LaterView app={app} part={robot.kind === 'bus' ? robotPage() : livePage()} wait="Loading …" />
        )}
      </main>
      <NoticeList state={app.state} />
      {openDialog.value !== 'none' && <LaterView app={app} part={dialogs()} wait="" />}
    </>
  );
}
