// The state of a joint's module, in the table of joints.
import type { RobotView } from '../view/robot_view.js';
import { moduleState } from '../state/module_text.js';

export function ModuleCell({ app, joint }: { app: RobotView; joint: number }) {
  const module = app.state.bus.value?.modules.find((candidate) => candidate.joint === joint);
  const { text, tone } = module === undefined ? { text: 'not on the bus', tone: 'bad' } : moduleState(module);
  return (
    <td class={`module ${tone}`} data-value="module" title={module?.advice ?? ''}>
      {text}
    </td>
  );
}
