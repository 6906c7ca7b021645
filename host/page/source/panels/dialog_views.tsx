// The dialogs: keys, palette, command line, and those that are loaded when they are opened.
import { useEffect, useState } from 'preact/hooks';
import type { Stores } from '../view/robot_view.js';
import type { Action, ActionList } from '../state/actions.js';
import { openDialog } from '../view/dialogs.js';
import { Dialog } from './dialog.js';
import { copyIcon } from './icons.js';
import { LaterView, loadLater } from './later_view.js';

const fileDiff = loadLater<Stores<'operations' | 'state'>>(() => import('./file_diff_dialog.js').then((module) => module.FileDiffDialog));
const valueTable = loadLater<Stores<'newGesture' | 'sets' | 'state'>>(() => import('./value_table_dialog.js').then((module) => module.ValueTableDialog));

const keyNames: Record<string, string> = {
  Escape: 'Esc',
  ArrowLeft: '←',
  ArrowRight: '→',
};

function keyText(key: string): string {
  return key
    .split('+')
    .map((part) => keyNames[part] ?? part)
    .join(' + ');
}

export function Keys({ actions, hint }: { actions: ActionList; hint: string }) {
  const withKeys = actions.all.filter((action) => action.keys.length > 0);
  const groups = [...new Set(withKeys.map((action) => action.group))];
  return (
    <Dialog title="Keys">
      <div class="key-groups">
        {groups.map((group) => (
          <section key={group}>
            <h3>{group}</h3>
            <dl>
              {withKeys
                .filter((action) => action.group === group)
                .map((action) => (
                  <div key={action.id}>
                    <dt>
                      <kbd>{keyText(action.keys[0] as string)}</kbd>
                    </dt>
                    <dd>{action.title}</dd>
                  </div>
                ))}
            </dl>
          </section>
        ))}
      </div>
      <p class="hint">{hint}</p>
    </Dialog>
  );
}

export function Palette({ actions }: { actions: ActionList }) {
  const [text, setText] = useState('');
  const [chosen, setChosen] = useState(0);
  const found = actions.matching(text);
  const current = Math.min(chosen, found.length - 1);
  const start = (action: Action | undefined) => {
    if (action !== undefined && action.isEnabled?.() !== false) {
      openDialog.value = 'none';
      action.run();
    }
  };
  const move = (event: KeyboardEvent) => {
    if (event.key === 'ArrowDown' || event.key === 'ArrowUp') {
      const step = event.key === 'ArrowDown' ? 1 : found.length - 1;
      setChosen((current + step) % Math.max(1, found.length));
      event.preventDefault();
    } else if (event.key === 'Enter') {
      start(found[current]);
      event.preventDefault();
    }
  };
  return (
    <Dialog title="Find an action">
      <input
        type="search"
        class="wide"
        role="combobox"
        aria-expanded="true"
        aria-controls="palette-list"
        aria-activedescendant={found[current] === undefined ? undefined : `action-${found[current].id}`}
        aria-label="Name of the action"
        placeholder="Type a word, e.g. restart"
        value={text}
        onInput={(event) => {
          setText(event.currentTarget.value);
          setChosen(0);
        }}
        onKeyDown={move}
      />
      <ul id="palette-list" role="listbox" aria-label="Actions" class="palette">
        {found.map((action, i) => (
          <li
            key={action.id}
            id={`action-${action.id}`}
            role="option"
            aria-selected={i === current}
            aria-disabled={action.isEnabled?.() === false}
            onClick={() => start(action)}
          >
            <span>{action.title}</span>
            {action.isEnabled?.() === false && <span class="hint">{action.obstacle?.() ?? 'needs control'}</span>}
            {action.keys[0] !== undefined && <kbd>{keyText(action.keys[0])}</kbd>}
          </li>
        ))}
      </ul>
      {found.length === 0 && <p class="hint">No action has these words.</p>}
    </Dialog>
  );
}

// The result of `command_line`; without a text if it was refused.
interface Command {
  text?: string;
  setpoint_hash?: string;
  servo_hash?: string;
  motion_hash?: string;
}

function CommandLine({ app }: { app: Stores<'operations'> }) {
  const [result, setResult] = useState<Command | null>(null);
  const [isCopied, setCopied] = useState(false);
  useEffect(() => {
    app.operations.tell('command_line', {}).then((value) => setResult((value ?? {}) as Command));
  }, []);
  const command = result === null ? null : (result.text ?? 'The program gave no command.');
  const copy = async () => {
    await navigator.clipboard.writeText(command ?? '');
    setCopied(true);
  };
  return (
    <Dialog title="Command that gives the same run">
      <pre class="command" tabIndex={0} data-testid="command">
        {command ?? 'Asking the program …'}
      </pre>
      {result?.setpoint_hash !== undefined && (
        <p class="hint">
          It prints what this run has had until now. Commands: set-point hash <code data-testid="setpoint-hash">{result.setpoint_hash}</code>,
          servo hash <code data-testid="servo-hash">{result.servo_hash}</code>. Motion, on the same program and processor: motion hash{' '}
          <code data-testid="motion-hash">{result.motion_hash}</code>.
        </p>
      )}
      <button type="button" class="primary" disabled={!command} onClick={() => void copy()}>
        {copyIcon} {isCopied ? 'Copied' : 'Copy'}
      </button>
    </Dialog>
  );
}

const robotHint =
  'Buttons: Enter. Esc, and Space outside text fields, stop the robot, in this window too. STOP does not replace a power switch.';
const simulationHint =
  'Buttons: Enter. Esc closes this window; without one it pauses the simulation. Space outside text fields is STOP, in this window too.';

export function DialogView({ app }: { app: Stores<'newGesture' | 'operations' | 'sets' | 'shownActions' | 'state'> }) {
  switch (openDialog.value) {
    case 'keys':
      return <Keys actions={app.shownActions} hint={app.state.robot.value?.kind === 'bus' ? robotHint : simulationHint} />;
    case 'palette':
      return <Palette actions={app.shownActions} />;
    case 'command_line':
      return <CommandLine app={app} />;
    case 'file_diff':
      return <LaterView app={app} part={fileDiff()} wait="" />;
    case 'value_table':
      return <LaterView app={app} part={valueTable()} wait="" />;
    case 'joint_table': // the page Make shows it
    case 'class': // the page of a class shows it
    case 'none':
      return null;
  }
}
