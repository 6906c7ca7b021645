// The page Live: the present motion of the robot.
import type { PageStores } from '../view/robot_view.js';
import { JointTable } from './joint_table.js';
import { ParameterPanel } from './parameter_panel.js';
import { PlotPanel } from './plot_panel.js';
import { RemoteSection } from './remote_section.js';
import { RunControls } from './run_controls.js';
import { ScenePanel } from './scene_panel.js';
import { StripPanel } from './strip_panel.js';
import { TimeControls } from './time_controls.js';

export function LivePage({ app }: { app: PageStores }) {
  return (
    <div class="live">
      <RunControls app={app} />
      <div class="live-main">
        <ScenePanel app={app} problem={app.state.simulation.value?.servo_problem ?? null} />
        <TimeControls app={app} />
        <StripPanel app={app} />
        <PlotPanel app={app} />
      </div>
      <div class="live-side">
        <ParameterPanel app={app} />
        <JointTable app={app} />
        <RemoteSection app={app} />
      </div>
    </div>
  );
}
