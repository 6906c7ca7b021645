// Start of the page: the parts that are needed at once. The others come as chunks of their own (panels/live_page.tsx).
import '@preact/signals';
import { render } from 'preact';
import { addFront, pressEscape } from './view/front.js';
import { listenToKeys } from './view/keyboard.js';
import { addActions } from './view/page_actions.js';
import { followPageHash, readPageHash } from './view/page_hash.js';
import { addRobotActions } from './view/robot_actions.js';
import { PageApp } from './page_app.js';
import { Frame } from './frame.js';
import { loadLater } from './panels/later_view.js';
import type { PageStores } from './view/robot_view.js';
import { personName, viewerName, viewerNumber } from './state/viewer_name.js';
import { fittingName } from './wire/messages.js';
import { takeToken } from './wire/access_token.js';
import { pageAddress } from './wire/page_address.js';
import './view/theme.js';

const recordingsPage = loadLater<PageStores>(() => import('./recordings/recordings_page.js').then((module) => module.RecordingsPage));
const root = document.getElementById('app') as HTMLElement;
const address = pageAddress(location);
const hash = readPageHash(location.hash);
const token = takeToken(location, history, sessionStorage, hash.token);

if (token === null) {
  render(
    <main class="lone-text">
      <h1>This address has no token</h1>
      {address.isSeat ? (
        <p>
          This is the robot of somebody in a class. <a href="/">Go to the start page of the class</a>.
        </p>
      ) : (
        <p>
          Open the address that <code>proleg ui</code> prints. It ends with <code>#</code> and the token.
        </p>
      )}
    </main>,
    root,
  );
} else {
  const name = personName(address.onlyLooks, sessionStorage) ?? viewerName(navigator.userAgent, viewerNumber(sessionStorage));
  const app = new PageApp(address, token, fittingName(name));
  addActions(app);
  addRobotActions(app);
  addFront({
    isOpen: () => app.shownPage.peek() === 'live' && app.mover.isActive.peek(),
    close: () => (app.mover.isOn.value = false),
  });
  listenToKeys({ forKey: (press, isText) => app.shownActions.forKey(press, isText) }, {
    space: () => app.stop.press(),
    escape: () => pressEscape(app),
  });
  followPageHash(app, hash, location, history);
  render(<Frame app={app} address={address} recordingsPage={recordingsPage} />, root);
}
