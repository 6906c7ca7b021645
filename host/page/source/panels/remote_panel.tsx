// Gamepads and the Wiimote: their present positions, and the bindings of their elements.
import { useSignal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import type { Stores } from '../view/robot_view.js';
import { firstBinding, positionOf, readLearned } from '../state/remote_bindings.js';
import type { RemoteDocument } from '../wire/messages.js';
import { RemoteBindingTable } from './remote_binding_table.js';

// The program shows positions for 5 s after this.
const watchPeriod = 2000; // milliseconds

function Bar({ name, kind, position }: { name: string; kind: 'axis' | 'button'; position: number }) {
  const middle = kind === 'axis' ? 50 : 0;
  const end = kind === 'axis' ? 50 + 50 * position : 100 * position;
  return (
    <li class="element">
      <span class="element-name">{name}</span>
      <span
        class={`element-bar ${kind}`}
        role="meter"
        aria-label={name}
        aria-valuemin={kind === 'axis' ? -1 : 0}
        aria-valuemax={1}
        aria-valuenow={Number(position.toFixed(2))}
      >
        <span class="element-fill" style={{ left: `${Math.min(middle, end)}%`, width: `${Math.abs(end - middle)}%` }} />
      </span>
    </li>
  );
}

function Devices({ app, remote }: { app: Stores<'state'>; remote: RemoteDocument }) {
  const values = app.state.remoteValues.value;
  if (remote.devices.length === 0) {
    return <p class="hint">Plug a gamepad in, or connect a Wiimote by Bluetooth. It appears here.</p>;
  }
  return (
    <>
      {remote.devices.map((device) => (
        <section key={device.id} aria-label={device.name}>
          <h3>{device.name}</h3>
          <ul class="elements">
            {device.elements.map(({ name, kind }, i) => (
              <Bar key={name} name={name} kind={kind} position={positionOf(values, device.id, i) ?? 0} />
            ))}
          </ul>
        </section>
      ))}
    </>
  );
}

function Tools({ app, remote }: { app: Stores<'operations' | 'state'>; remote: RemoteDocument }) {
  const { state, operations } = app;
  const isHolder = state.isHolder.value;
  const isAsked = useSignal(false);
  const add = async () => {
    isAsked.value = true;
    try {
      const learned = readLearned(await operations.ask('remote.learn', {}));
      if (learned !== null) {
        await operations.tell('remote.bind', { binding: firstBinding(learned, state.parameters.value) });
      }
    } catch (error) {
      if (isAsked.value) state.addNotice('warning', (error as Error).message);
    }
    isAsked.value = false;
  };
  const cancel = () => {
    isAsked.value = false; // the user needs no notice that nothing was moved
    void operations.tell('remote.learn', { end: true });
  };
  return (
    <div class="toolbar" role="toolbar" aria-label="Bindings">
      {remote.learning ? (
        <>
          <strong role="status">Move it now …</strong>
          <button type="button" disabled={!isHolder} onClick={cancel}>
            Cancel
          </button>
        </>
      ) : (
        <button
          type="button"
          disabled={!isHolder || remote.devices.length === 0}
          onClick={() => void add()}
          title="The stick or button that you move next is bound. It has no other effect then."
        >
          Add: move it now
        </button>
      )}
      <button
        type="button"
        disabled={!isHolder || remote.saved || remote.file === null}
        onClick={() => void operations.tell('remote.save', {})}
        title={remote.file === null ? 'There is no scenario file to save beside: start `proleg ui FILE`' : `Saves ${remote.file}, for the next start`}
      >
        {remote.saved ? 'Saved' : 'Save'}
      </button>
    </div>
  );
}

export function RemotePanel({ app }: { app: Stores<'operations' | 'state'> }) {
  const { state, operations } = app;
  const isConnected = state.isConnected.value;
  useEffect(() => {
    if (!isConnected) {
      return undefined;
    }
    const watch = () => {
      if (!document.hidden) operations.ask('remote.watch', {}).catch(() => undefined);
    };
    watch();
    const timer = setInterval(watch, watchPeriod);
    return () => clearInterval(timer);
  }, [isConnected]);
  const remote = state.remote.value;
  if (remote === null) {
    return <p class="hint">This program has no remote control.</p>;
  }
  return (
    <div class="remote-body">
      {remote.problems.map((problem) => (
        <p key={problem} class="problem">
          {problem}
        </p>
      ))}
      <Devices app={app} remote={remote} />
      <Tools app={app} remote={remote} />
      {remote.bindings.length > 0 && <RemoteBindingTable app={app} remote={remote} />}
      <p class="hint">It has an effect only while somebody has control. A bound STOP works always.</p>
    </div>
  );
}
