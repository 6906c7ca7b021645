// The frame of the page: top bar, bands, notices, dialogs; the page below it comes later.
import { useEffect } from 'preact/hooks';
import type { PageStores } from './view/robot_view.js';
import { openDialog } from './view/dialogs.js';
import { Bands } from './panels/bands.js';
import { LaterView, loadLater, loadWhenIdle, type Later } from './panels/later_view.js';
import { NoticeList } from './panels/notice_list.js';
import { TopBar } from './panels/top_bar.js';
import type { PageAddress } from './wire/page_address.js';

const livePage = loadLater<PageStores>(() => import('./panels/live_page.js').then((module) => module.LivePage));
// A robot on a bus has panels of its own.
const robotPage = loadLater<PageStores>(() => import('./panels/bus/robot_page.js').then((module) => module.RobotPage));
const dialogs = loadLater<PageStores>(() => import('./panels/dialog_views.js').then((module) => module.DialogView));
livePage();
dialogs();
// These pages are loaded when they are first shown, or when the robot is there and the browser has nothing else to do.
let wereRecordingsShown = false;
let wasMakeShown = false;
let wereModulesShown = false;
const makePage = loadLater<PageStores>(() => import('./make/make_page.js').then((module) => module.MakePage));
const modulesPage = loadLater<PageStores>(() => import('./modules/modules_page.js').then((module) => module.ModulesPage));

// A page stays when another one is shown. `recordingsPage`: loads the page Recordings.
export function Frame({ app, address, recordingsPage }: { app: PageStores; address: PageAddress; recordingsPage: () => Later<PageStores> }) {
  const page = app.shownPage.value;
  const isAlone = app.state.isAlone.value;
  if (page === 'recordings') wereRecordingsShown = true;
  if (page === 'make') wasMakeShown = true;
  if (page === 'modules') wereModulesShown = true;
  const robot = app.state.robot.value;
  const hasRobot = robot !== null;
  useEffect(() => {
    if (hasRobot) loadWhenIdle([recordingsPage, makePage, modulesPage]);
  }, [hasRobot]);
  return (
    <>
      <TopBar app={app} />
      <Bands app={app} address={address} />
      <main id="page">
        {!isAlone && (
          <div hidden={page !== 'live'}>
            {robot === null ? (
              <p class="wait">Waiting for the robot …</p>
            ) : (
              <LaterView app={app} part={robot.kind === 'bus' ? robotPage() : livePage()} wait="Loading …" />
            )}
          </div>
        )}
        {wereRecordingsShown && (
          <div hidden={page !== 'recordings'}>
            <LaterView app={app} part={recordingsPage()} wait="Loading …" />
          </div>
        )}
        {wasMakeShown && (
          <div hidden={page !== 'make'}>
            <LaterView app={app} part={makePage()} wait="Loading …" />
          </div>
        )}
        {wereModulesShown && (
          <div hidden={page !== 'modules'}>
            <LaterView app={app} part={modulesPage()} wait="Loading …" />
          </div>
        )}
      </main>
      <NoticeList app={app} />
      {openDialog.value !== 'none' && <LaterView app={app} part={dialogs()} wait="" />}
    </>
  );
}
