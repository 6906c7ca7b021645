// The comparison of the modules' state frames with the gait of this computer.
import type { Stores } from '../../view/robot_view.js';
import { describeGait } from '../../state/gait_text.js';

export function GaitPanel({ app }: { app: Stores<'state'> }) {
  const gait = app.state.busSession.value?.gait ?? null;
  const { text, tone } = describeGait(gait);
  return (
    <section class="panel gait-panel" aria-label="Comparison with the gait">
      <h2 title="The modules compute the gait themselves. Their state frames must have the bits that this computer gets.">
        Modules against the gait
      </h2>
      <p class={`verdict ${tone}`} data-testid="gait">
        {text}
      </p>
      {gait?.first_difference && <p>First difference: {gait.first_difference}</p>}
      {gait?.end && <p class="hint">Nothing is compared any more: {gait.end}</p>}
    </section>
  );
}
