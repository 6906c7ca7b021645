// A button for a robot on a bus. When the command is not possible, it is disabled and says why.
import type { ComponentChildren } from 'preact';
import type { Stores } from '../../view/robot_view.js';
import type { RobotCommand } from '../../state/robot_commands.js';

interface Properties {
  app: Stores<'state'>;
  command: RobotCommand;
  title: string;
  run(): void;
  isPrimary?: boolean;
  isPressed?: boolean;
  children: ComponentChildren;
}

export function CommandButton({ app, command, title, run, isPrimary = false, isPressed, children }: Properties) {
  const obstacle = app.state.obstacleTo(command);
  return (
    <button
      type="button"
      class={isPrimary ? 'primary' : ''}
      disabled={obstacle !== null}
      aria-pressed={isPressed}
      onClick={run}
      title={obstacle ?? title}
    >
      {children}
    </button>
  );
}
