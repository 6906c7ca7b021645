// The page of a recording: the panels of the live page, with a time line instead of controls of a robot.
import { openDialog } from '../view/dialogs.js';
import { Keys, Palette } from '../panels/dialog_views.js';
import { JointTable } from '../panels/joint_table.js';
import { PageTools } from '../panels/page_tools.js';
import { PlotPanel } from '../panels/plot_panel.js';
import { ScenePanel } from '../panels/scene_panel.js';
import { StripPanel } from '../panels/strip_panel.js';
import { MarkList } from './mark_list.js';
import { PlaybackControls } from './playback_controls.js';
import type { PlayerApp } from './player_app.js';
import { RecordingFacts } from './recording_facts.js';

function Header({ app }: { app: PlayerApp }) {
  const { recording } = app;
  const robot = app.state.robot.value;
  const seconds = (recording.last_tick + 1 - recording.first_tick) / app.tickRate;
  const algorithms = [...new Set(robot?.slots.map((slot) => slot.algorithm))].join(', ');
  return (
    <header class="top-bar">
      <div class="robot-name">
        <strong class="badge recording" title="What a robot did.">
          RECORDING
        </strong>
        <h1 class="name" title={recording.file}>
          {recording.file}
        </h1>
        <span class="about unit" title={algorithms} data-testid="about">
          {`${Number(seconds.toFixed(2))} s, ${robot?.name}, ${algorithms}`}
        </span>
      </div>
      <PageTools />
    </header>
  );
}

function Bands({ app }: { app: PlayerApp }) {
  const { recording, failure, loaded } = app;
  return (
    <div class="bands">
      {failure.value !== null && (
        <div class="band lost" role="alert">
          {failure.value}
        </div>
      )}
      {failure.value === null && loaded.value < 1 && (
        <div class="band info" role="status">
          Reading … {Math.round(loaded.value * 100)} %
        </div>
      )}
      {!recording.has_path && (
        <div class="band info" data-testid="no-path">
          Where the robot was is not measured: the joints move about a head that stands still.
        </div>
      )}
      {!recording.finished && (
        <div class="band info" data-testid="unfinished">
          The run had not finished when this file was made.
        </div>
      )}
    </div>
  );
}

function DialogView({ app }: { app: PlayerApp }) {
  switch (openDialog.value) {
    case 'keys':
      return <Keys actions={app.actions} hint="Buttons: Enter. Drag the time line or the strip to move the time cursor." />;
    case 'palette':
      return <Palette actions={app.actions} />;
    default:
      return null;
  }
}

export function PlayerPage({ app }: { app: PlayerApp }) {
  return (
    <>
      <Header app={app} />
      <Bands app={app} />
      <main id="page">
        <div class={app.recording.has_path ? 'live' : 'live no-path'}>
          <PlaybackControls app={app} />
          <div class="live-main">
            <ScenePanel app={app} />
            <StripPanel app={app} />
            <PlotPanel app={app} />
          </div>
          <div class="live-side">
            <JointTable app={app} />
            <MarkList app={app} />
            <RecordingFacts app={app} />
          </div>
        </div>
      </main>
      <DialogView app={app} />
    </>
  );
}
