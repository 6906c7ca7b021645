// The page Recordings: the list, or the recording that is shown with the panels of the live page.
import { JointTable } from '../panels/joint_table.js';
import { PlotPanel } from '../panels/plot_panel.js';
import { ScenePanel } from '../panels/scene_panel.js';
import { StripPanel } from '../panels/strip_panel.js';
import { MarkList } from '../player/mark_list.js';
import { PlaybackControls } from '../player/playback_controls.js';
import { RecordingFacts } from '../player/recording_facts.js';
import type { OpenedRecording } from './opened_recording.js';
import { ExportTools } from './export_tools.js';
import { ComparisonBand } from './comparison_band.js';
import { XyPanel } from './xy_panel.js';
import { RecordingList } from './recording_list.js';
import { RecordingsApp, type RecordingsStores } from './recordings_app.js';

let recordings: RecordingsApp | null = null; // the only one of the page; it stays when another page is shown

function RecordingBands({ opened }: { opened: OpenedRecording }) {
  const { recording } = opened;
  const ticks = recording.last_tick - recording.first_tick + 1;
  const problem = opened.failure.value ?? recording.damage;
  return (
    <div class="bands">
      <ComparisonBand opened={opened} />
      {problem !== null && (
        <div class="band lost" role="alert">
          {problem}
        </div>
      )}
      {recording.damage === null && recording.indexed < ticks && ticks > 2048 && (
        <div class="band info" role="status" data-testid="indexing">
          Reading the whole recording for long views … {Math.floor((100 * recording.indexed) / ticks)} %
        </div>
      )}
      {!recording.finished && (
        <div class="band info" role="status" data-testid="growing">
          This recording is not finished: it grows, or was interrupted. At its end the time cursor goes with it (End).
        </div>
      )}
      {!recording.has_path && (
        <div class="band info">Where the robot was is not measured: the joints move about a head that stands still.</div>
      )}
    </div>
  );
}

function OpenedView({ app, opened }: { app: RecordingsApp; opened: OpenedRecording }) {
  return (
    <>
      <div class="recording-head">
        <button type="button" onClick={() => app.close()} title="Back to the list (Backspace)">
          ← Recordings
        </button>
        <h1 class="name" data-testid="opened">
          {opened.client.file}
        </h1>
        <span class="unit">{opened.state.robot.value?.name}</span>
        <button
          type="button"
          onClick={() => app.chooseSecond(opened.client.file)}
          title="Shows a second recording beside this one: its lines are dashed, its robot is translucent (D)"
        >
          Compare with …
        </button>
        <button
          type="button"
          disabled={app.obstacleToContinue(opened) !== null}
          onClick={() => void app.continueFrom(opened)}
          title={
            app.obstacleToContinue(opened) ??
            'Computes the same run again up to the time cursor, bit for bit. It stands there, and you drive on. The simulation that is live now ends.'
          }
        >
          Continue from here
        </button>
        <span class="space" />
        <ExportTools opened={opened} />
      </div>
      <RecordingBands opened={opened} />
      <div class={opened.recording.has_path ? 'live recorded' : 'live recorded no-path'}>
        <PlaybackControls app={opened} />
        <div class="live-main">
          <ScenePanel app={opened} />
          <StripPanel app={opened} />
          <PlotPanel app={opened} />
          <XyPanel app={opened} />
        </div>
        <div class="live-side">
          <JointTable app={opened} />
          <MarkList app={opened} />
          <RecordingFacts app={opened} second={opened.compared.value} />
        </div>
      </div>
    </>
  );
}

export function RecordingsPage({ app: page }: { app: RecordingsStores }) {
  recordings ??= new RecordingsApp(page);
  const app = recordings;
  const opened = app.opened.value;
  if (opened !== null && app.comparing.value === null) {
    return <OpenedView key={opened.client.file} app={app} opened={opened} />;
  }
  return app.opening.value !== null ? <p class="wait">Opening {app.opening.value} …</p> : <RecordingList app={app} />;
}
