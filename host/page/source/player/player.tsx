// Start of the player: one file with page and recording, opened from a folder. It has no server and no network.
import '@preact/signals';
import { render } from 'preact';
import { onFrame } from '../view/frame_clock.js';
import { listenToKeys } from '../view/keyboard.js';
import '../view/theme.js';
import { EmbeddedRecording } from './embedded_recording.js';
import { addPlayerActions } from './player_actions.js';
import { PlayerApp } from './player_app.js';
import { PlayerPage } from './player_page.js';

const longestFrame = 250; // milliseconds: a tab that was hidden goes on where it was

// The worker is text in this page: a page from a file may not read another file.
function startSceneWorker(): Worker {
  const program = document.getElementById('scene-worker')?.textContent ?? '';
  return new Worker(URL.createObjectURL(new Blob([program], { type: 'text/javascript' })));
}

function playOnFrames(app: PlayerApp): void {
  let before = performance.now();
  onFrame((now) => {
    app.time.advance(Math.min(longestFrame, Math.max(0, now - before)));
    before = now;
  });
}

async function start(root: HTMLElement): Promise<void> {
  const app = new PlayerApp(new EmbeddedRecording(document), startSceneWorker);
  document.title = `${app.recording.file} – Proleg`;
  addPlayerActions(app);
  listenToKeys(app.actions, null);
  root.textContent = '';
  root.className = '';
  render(<PlayerPage app={app} />, root);
  playOnFrames(app);
  await app.load();
  const isStill = window.matchMedia('(prefers-reduced-motion: reduce)').matches;
  if (!isStill && app.failure.value === null) {
    app.time.toggle();
  }
}

const root = document.getElementById('app') as HTMLElement;
start(root).catch((error: Error) => (root.textContent = `This recording cannot be shown. ${error.message}`));
