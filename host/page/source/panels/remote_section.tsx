// Remote control: closed, one line; its panel is loaded when it is opened.
import { signal } from '@preact/signals';
import type { Stores } from '../view/robot_view.js';
import { describeRemote } from '../state/remote_bindings.js';
import { LaterView, loadLater } from './later_view.js';

const panel = loadLater<Stores<'operations' | 'state'>>(() => import('./remote_panel.js').then((module) => module.RemotePanel));
const isOpen = signal(false);

export function RemoteSection({ app }: { app: Stores<'operations' | 'state'> }) {
  const remote = app.state.remote.value;
  const problems = remote?.problems.length ?? 0;
  return (
    <details
      class="panel remote-panel"
      open={isOpen.value}
      onToggle={(event) => {
        isOpen.value = event.currentTarget.open;
      }}
    >
      <summary>
        <h2>Remote control</h2>
        <span class="hint" data-testid="remote-status">
          {describeRemote(remote)}
        </span>
        {problems > 0 && <span class="problem">{problems === 1 ? '1 problem' : `${problems} problems`}</span>}
      </summary>
      {isOpen.value && <LaterView app={app} part={panel()} wait="Loading …" />}
    </details>
  );
}
