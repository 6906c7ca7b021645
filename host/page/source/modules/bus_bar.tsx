// Which bus is open, and which ones can be.
import { useSignal } from '@preact/signals';
import { Findings } from './doctor_part.js';
import { isRunning } from './job_text.js';
import type { ModulesApp } from './modules_app.js';

function busState(app: ModulesApp): { text: string; tone: string } {
  const bus = app.bus.value;
  if (bus?.connected !== true) return { text: 'no connection', tone: 'bad' };
  if (bus.other_host) return { text: 'another host drives modules here', tone: 'bad' };
  return { text: `open, load ${(100 * bus.load).toFixed(1)} %`, tone: 'good' };
}

function OpenBus({ app }: { app: ModulesApp }) {
  const modules = app.modules.value;
  const { text, tone } = busState(app);
  const obstacle = app.answerObstacle() ?? (app.job.value !== null && app.job.value.state !== 'ended' ? 'A job goes on.' : null);
  return (
    <>
      <h2 class="bus-name" title={modules?.description ?? ''}>
        Bus {modules?.bus}
      </h2>
      <span class={`verdict ${tone}`} role="status" data-testid="bus-state">
        {text}
      </span>
      {modules?.description != null && modules.description !== modules.bus && <span class="hint">{modules.description}</span>}
      {modules?.is_fixed === true ? (
        <span class="hint">Proleg was started with this bus.</span>
      ) : (
        <button type="button" disabled={obstacle !== null} title={obstacle ?? 'Other programs can use the adapter then'} onClick={() => void app.tell('modules.close', {})}>
          Close
        </button>
      )}
    </>
  );
}

// Says why a bus does not open, or what is wrong with it.
function ExamineButton({ app, bus }: { app: ModulesApp; bus: string }) {
  const obstacle = !app.page.state.isConnected.value
    ? 'No connection to the program.'
    : bus === ''
      ? 'Write an address first.'
      : app.job.value !== null && isRunning(app.job.value)
        ? 'A job goes on.'
        : null;
  return (
    <button type="button" disabled={obstacle !== null} title={obstacle ?? 'Examines the adapter and the bus; it only reads'} onClick={() => void app.tell('modules.examine', { bus })}>
      What is wrong?
    </button>
  );
}

function ChooseBus({ app }: { app: ModulesApp }) {
  const typed = useSignal('');
  const isOpening = useSignal(false);
  const offers = app.modules.value?.offers ?? [];
  const obstacle = app.answerObstacle() ?? (isOpening.value ? 'A bus is being opened.' : null);
  const open = async (bus: string) => {
    isOpening.value = true;
    await app.tell('modules.open', { bus });
    isOpening.value = false;
  };
  return (
    <>
      <h2>Open a bus</h2>
      <ul class="fields" aria-label="Buses of this computer">
        {offers.map(({ address, text }) => (
          <li key={address}>
            <button type="button" class={offers.length === 1 ? 'primary' : ''} disabled={obstacle !== null} title={obstacle ?? text} onClick={() => void open(address)}>
              {address}
            </button>{' '}
            <span class="hint">{text}</span> <ExamineButton app={app} bus={address} />
          </li>
        ))}
      </ul>
      {offers.length === 0 && <span class="hint">This computer has no CAN interface and no serial adapter.</span>}
      <button type="button" title="Looks for interfaces and adapters again" onClick={() => void app.tell('modules.look', {})}>
        Look again
      </button>
      <form
        class="fields"
        onSubmit={(event) => {
          event.preventDefault();
          if (typed.peek().trim() !== '' && obstacle === null) void open(typed.peek().trim());
        }}
      >
        <label class="number-field" title="serial:/dev/ttyUSB0, bluetooth:AA:BB:CC:DD:EE:FF, tcp:HOST:PORT, or sim:FILE.simulation.xml for simulated modules">
          <span>another address</span>
          <input type="text" size={24} name="bus" placeholder="tcp:HOST:PORT" autocomplete="off" spellcheck={false} value={typed.value} onInput={(event) => (typed.value = event.currentTarget.value)} />
        </label>
        <button type="submit" disabled={obstacle !== null || typed.value.trim() === ''} title={obstacle ?? (typed.value.trim() === '' ? 'Write an address first.' : 'Opens this bus')}>
          Open
        </button>
        <ExamineButton app={app} bus={typed.value.trim()} />
      </form>
      {isOpening.value && <span role="status">Opening …</span>}
      {app.answerObstacle() !== null && <span class="hint">{app.answerObstacle()}</span>}
    </>
  );
}

export function BusBar({ app }: { app: ModulesApp }) {
  const problem = app.bus.value?.problem ?? null;
  return (
    <section class="panel modules-panel" aria-label="Bus" data-testid="modules-bus">
      <div class="fields">{app.isOpen.value ? <OpenBus app={app} /> : <ChooseBus app={app} />}</div>
      {!app.isOpen.value && (
        <p class="hint">
          Then you see the modules on it, give them their places in a robot, change their settings, flash them, and find out what is wrong with them. The robot on the
          page Live stays what it is.
        </p>
      )}
      {!app.isOpen.value && <Findings app={app} />}
      {problem !== null && (
        <p class="problem" role="alert">
          {problem}
        </p>
      )}
    </section>
  );
}
