// The page Live of a robot on a bus.
import { useEffect } from 'preact/hooks';
import type { PageStores } from '../../view/robot_view.js';
import { JointTable } from '../joint_table.js';
import { ParameterPanel } from '../parameter_panel.js';
import { PlotPanel } from '../plot_panel.js';
import { RemoteSection } from '../remote_section.js';
import { ScenePanel } from '../scene_panel.js';
import { StripPanel } from '../strip_panel.js';
import { TimeControls } from '../time_controls.js';
import { BusPanel } from './bus_panel.js';
import { GaitPanel } from './gait_panel.js';
import { PosePanel } from './pose_panel.js';
import { RobotControls } from './robot_controls.js';

export function RobotPage({ app }: { app: PageStores }) {
  // The lines before the user chooses some: measured angles and set-points.
  useEffect(() => app.selection.begin(['angle', 'setpoint', 'simulated_angle']), []);
  return (
    <div class={`live ${app.state.freshness.age.value === null ? '' : 'old'}`}>
      <RobotControls app={app} />
      <div class="live-main">
        <ScenePanel app={app} />
        <TimeControls app={app} />
        <StripPanel app={app} />
        <PlotPanel app={app} />
        <BusPanel app={app} />
      </div>
      <div class="live-side">
        <PosePanel app={app} />
        <JointTable app={app} />
        <GaitPanel app={app} />
        <ParameterPanel app={app} />
        <RemoteSection app={app} />
      </div>
    </div>
  );
}
