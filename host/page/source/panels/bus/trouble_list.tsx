// The list of modules with faults, and of the remedies.
import type { Stores } from '../../view/robot_view.js';
import { troublesOf } from '../../state/module_text.js';

export function TroubleList({ app }: { app: Stores<'state'> }) {
  const troubles = troublesOf(app.state.bus.value, app.state.robot.value);
  return troubles.length === 0 ? null : (
    <section class="panel trouble-panel" aria-label="Faults" data-testid="troubles">
      <h2>What to do</h2>
      <ul>
        {troubles.map(({ node, text, advice }) => (
          <li key={node}>
            <strong>{text}</strong> {advice}
          </li>
        ))}
      </ul>
    </section>
  );
}
