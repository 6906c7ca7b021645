// The load of the bus, and all modules on it, also those that do not belong to this robot.
import type { Stores } from '../../view/robot_view.js';
import { currentState, moduleState } from '../../state/module_text.js';
import type { BusDocument, BusModule } from '../../wire/messages.js';
import { TableHead } from '../table_head.js';
import { CommandButton } from './command_button.js';

function Facts({ bus }: { bus: BusDocument }) {
  const facts = [
    { title: 'load', help: 'Share of the time in which frames are on the bus', text: `${(100 * bus.load).toFixed(1)} %` },
    { title: 'SYNC', help: 'SYNC frames of the last second', text: `${bus.syncs} a second` },
    { title: 'answer', help: 'From a request to the answer of a module', text: bus.latency_ms === null ? '–' : `${bus.latency_ms.toFixed(1)} ms` },
  ];
  return (
    <dl class="figures">
      {facts.map(({ title, help, text }) => (
        <div key={title} title={help}>
          <dt>{title}</dt>
          <dd>{bus.connected ? text : '–'}</dd>
        </div>
      ))}
    </dl>
  );
}

const measured = (value: number | null, decimals: number) => (value === null ? '–' : value.toFixed(decimals));

const limitText = (limit: number | null) => (limit === 0 ? 'off' : measured(limit, 0));

function stopText(confirmed: boolean | null): string {
  return confirmed === null ? '–' : confirmed ? 'confirmed' : 'NOT CONFIRMED';
}

function ModuleRow({ app, module }: { app: Stores<'selection' | 'state'>; module: BusModule }) {
  const { joint } = module;
  const { text, tone } = moduleState(module);
  const current = currentState(module.current, module.current_limit);
  const isLit = joint !== null && app.selection.hoveredJoint.value === joint;
  return (
    <tr
      class={`${isLit ? 'hovered' : ''} ${module.silent ? 'silent' : ''}`}
      data-node={module.node}
      onPointerEnter={() => (app.selection.hoveredJoint.value = joint)}
      onPointerLeave={() => (app.selection.hoveredJoint.value = null)}
    >
      <th scope="row">{module.node}</th>
      <td>{joint === null ? 'not of this robot' : (app.state.robot.value?.joints[joint]?.name ?? '–')}</td>
      <td>{module.state ?? '–'}</td>
      <td class={`module ${tone}`}>{text}</td>
      <td>{measured(module.angle, 1)}</td>
      <td class={current.tone} data-value="current">
        {current.text}
      </td>
      <td data-value="limit">{limitText(module.current_limit)}</td>
      <td>{measured(module.temperature, 0)}</td>
      <td class={module.stop_confirmed === false ? 'module bad' : ''}>{stopText(module.stop_confirmed)}</td>
    </tr>
  );
}

export function BusPanel({ app }: { app: Stores<'operations' | 'selection' | 'state'> }) {
  const bus = app.state.bus.value;
  return (
    <section class={`panel bus-panel ${bus?.connected === true ? '' : 'old'}`} aria-label="Bus" data-testid="bus">
      <div class="panel-head">
        <h2>Bus {bus?.address}</h2>
        {bus !== null && <Facts bus={bus} />}
        <span class="space" />
        <CommandButton
          app={app}
          command="scan"
          run={() => void app.operations.tell('scan', {})}
          title="Looks for modules again; only without power"
        >
          Scan again
        </CommandButton>
      </div>
      <div class="table-frame" tabIndex={0} role="group" aria-label="Table of modules">
        <table>
          <TableHead titles={['node', 'joint', 'NMT', 'drive', 'angle °', 'current mA', 'limit mA', '°C', 'last STOP']} />
          <tbody>
            {bus?.modules.map((module) => (
              <ModuleRow key={module.node} app={app} module={module} />
            ))}
          </tbody>
        </table>
      </div>
      {bus?.modules.length === 0 && <p class="hint">No module answers. Look at power and cable, then scan again.</p>}
    </section>
  );
}
