// Bands below the top bar: facts that the user must know, and questions that need an answer now.
import { useEffect, useState } from 'preact/hooks';
import type { Stores } from '../view/robot_view.js';
import { namedJoints } from '../state/named_joints.js';
import type { PageAddress } from '../wire/page_address.js';
import { BusBands } from './bus_bands.js';
import { ConnectionBand } from './connection_band.js';
import { loadLater, LaterView } from './later_view.js';
import { ProgramBand } from './program_band.js';

// Only in a class.
const handedOut = loadLater<Stores<'shownPage' | 'state' | 'wantedScenario'>>(() => import('./handed_out_band.js').then((module) => module.HandedOutBand));

// The remaining seconds. They are counted down here, because the document has them only once.
function Countdown({ ms }: { ms: number }) {
  const [end] = useState(() => performance.now() + ms);
  const [left, setLeft] = useState(ms);
  useEffect(() => {
    const timer = setInterval(() => setLeft(Math.max(0, end - performance.now())), 250);
    return () => clearInterval(timer);
  }, [end]);
  return <>{Math.ceil(left / 1000)} s</>;
}

function RequestBand({ app }: { app: Stores<'operations' | 'state'> }) {
  const request = app.state.control.value?.request ?? null;
  if (request === null) {
    return null;
  }
  if (request.client === app.state.client.value) {
    return (
      <div class="band info" role="status">
        You asked for control. It is yours in <Countdown key={request.client} ms={request.ms} />, unless the other viewer refuses.
      </div>
    );
  }
  if (!app.state.isHolder.value) {
    return null;
  }
  const answer = (grant: boolean) => void app.operations.tell('control.answer', { grant });
  return (
    <div class="band question" role="alert">
      <span>
        <strong>{request.name}</strong> asks for control. It passes in <Countdown key={request.client} ms={request.ms} />.
      </span>
      <button type="button" class="primary" onClick={() => answer(true)}>
        Give control
      </button>
      <button type="button" onClick={() => answer(false)}>
        Keep control
      </button>
    </div>
  );
}

export function Bands({ app, address }: { app: Stores<'operations' | 'shownPage' | 'state' | 'wantedScenario'>; address: PageAddress }) {
  const hasHandOut = app.state.handedOut.value.length > 0 && !address.onlyLooks;
  const session = app.state.session.value;
  const repeats = app.state.simulation.value?.repeats;
  return (
    <div class="bands">
      <ConnectionBand status={app.state.connection.value} isSeat={address.isSeat} />
      <ProgramBand app={app} isSeat={address.isSeat} />
      <BusBands app={app} />
      {session?.failure && (
        <div class="band lost" role="alert">
          {namedJoints(session.failure, app.state.robot.value?.joints ?? [])}
        </div>
      )}
      {repeats && (
        <div class="band info" role="status" data-testid="repeats">
          <span>
            Computing {repeats.file} again: tick {session?.tick} of {repeats.tick}.
          </span>
          <button type="button" disabled={!app.state.isHolder.value} onClick={() => void app.operations.tell('pause', {})}>
            Stay where it is
          </button>
        </div>
      )}
      <RequestBand app={app} />
      {hasHandOut && <LaterView app={app} part={handedOut()} wait="" />}
    </div>
  );
}
