// Groups of lines over time.
import type { RobotView } from '../view/robot_view.js';
import { addIcon } from './icons.js';
import { LineGroupView } from './line_group.js';

export function PlotPanel({ app }: { app: RobotView }) {
  return (
    <section class="panel plot-panel" aria-label="Plots">
      {app.selection.groups.value.map((group) => (
        <LineGroupView key={group.number} app={app} group={group} />
      ))}
      <button type="button" class="add-group" onClick={() => app.selection.addGroup()}>
        {addIcon} Add a plot
      </button>
    </section>
  );
}
