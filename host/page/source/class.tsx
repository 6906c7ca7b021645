// Start of the page of a class: the entry of learners, or with a token the page of the teacher.
import '@preact/signals';
import { effect } from '@preact/signals-core';
import { render } from 'preact';
import { ClassApp } from './class/class_app.js';
import { ClassPage } from './class/class_page.js';
import { EntryPage } from './class/entry_page.js';
import { EntryState } from './class/entry_state.js';
import { codeInHash } from './class/join.js';
import { KeyStore, makeKey } from './class/key_store.js';
import { personKey } from './state/viewer_name.js';
import { closeFront } from './view/front.js';
import { listenToKeys } from './view/keyboard.js';
import { dropToken, takeToken } from './wire/access_token.js';
import { pageAddress } from './wire/page_address.js';
import './view/theme.js';

const longestWait = 20_000; // milliseconds, for the robot of a learner

const root = document.getElementById('app') as HTMLElement;

function showEntry(): void {
  const entry = new EntryState(codeInHash(location.hash), new KeyStore(localStorage), new KeyStore(sessionStorage), {
    post: async (wish) => {
      const response = await fetch('/join', { method: 'POST', body: JSON.stringify(wish), signal: abortAfter(longestWait) });
      return { status: response.status, body: await response.text() };
    },
    enter: ({ name, path, token }) => {
      sessionStorage.setItem(personKey, name);
      location.assign(`${path}#${token}`);
    },
    makeKey,
  });
  // Back from the robot: a browser may show this page as it was left.
  window.addEventListener('pageshow', () => (entry.isBusy.value = false));
  render(<EntryPage entry={entry} />, root);
}

function abortAfter(ms: number): AbortSignal {
  const controller = new AbortController();
  setTimeout(() => controller.abort(), ms);
  return controller.signal;
}

function showClass(token: string): void {
  const app = new ClassApp(pageAddress(location), token);
  // Else this tab could never show the entry again.
  effect(() => {
    if (app.state.connection.value.state === 'refused') dropToken(location, sessionStorage);
  });
  listenToKeys({ forKey: () => undefined }, { space: () => app.stop.press(), escape: () => void closeFront() });
  render(<ClassPage app={app} />, root);
}

// An address that differs only in its fragment does not load the page anew.
window.addEventListener('hashchange', () => location.reload());

const isForLearners = location.hash.startsWith('#join=');
const token = isForLearners ? null : takeToken(location, history, sessionStorage);
if (token === null) showEntry();
else showClass(token);
