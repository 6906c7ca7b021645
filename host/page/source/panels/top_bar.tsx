// The bar that is always visible: the robot, its state, the viewer who has control, STOP.
import type { PageName, Stores } from '../view/robot_view.js';
import type { PageState } from '../state/page_state.js';
import type { SessionDocument } from '../wire/messages.js';
import { DocumentationLink } from './documentation_link.js';
import { documentationIcon } from './icons.js';
import { PageTools } from './page_tools.js';
import { StopArea } from './stop_area.js';

const badges = {
  simulation: { text: 'SIMULATION', title: 'A simulated robot: nothing on the table moves.' },
  bus: { text: 'ROBOT', title: 'A real robot: it moves.' },
  recording: { text: 'RECORDING', title: 'What a robot did.' },
  draft: { text: 'DRAFT', title: 'What a robot will be.' },
} as const;

const states: Record<SessionDocument['state'], string> = {
  running: 'running',
  paused: 'paused',
  stopped: 'STOPPED',
  failed: 'FAILED',
  off: 'power off',
  starting: 'starting',
  held: 'holding',
  stopping: 'stopping',
};

function stateText(session: SessionDocument): string {
  return session.kind === 'bus' && session.state === 'running' ? 'gait' : states[session.state];
}

function RobotName({ state }: { state: PageState }) {
  const robot = state.robot.value;
  const session = state.session.value;
  const isConnected = state.isConnected.value;
  const isAlone = state.isAlone.value;
  const seat = state.seat.value;
  const badge = robot !== null ? badges[robot.kind] : isAlone ? badges.recording : null;
  // Beside a simulated robot a bus may be open for its modules only.
  const address = robot?.kind === 'bus' ? state.bus.value?.address : '';
  return (
    <div class="robot-name">
      {seat !== null && (
        <strong class="person" title={seat.name} data-testid="person">
          {seat.name}
        </strong>
      )}
      {badge !== null && (
        <strong class={`badge ${robot?.kind ?? 'recording'}`} title={`${badge.title} ${address ?? ''}`}>
          {badge.text} {address}
        </strong>
      )}
      <span class="name" title={robot?.file}>
        {robot?.name ?? (isAlone ? state.recordings.value?.folder : 'no robot yet')}
      </span>
      {session !== null && (
        <span
          class={`state ${isConnected ? session.state : ''}`}
          data-testid="state"
          title={session.stopped_by ? `stopped by ${session.stopped_by}` : undefined}
        >
          {isConnected ? stateText(session) : 'state unknown'}
        </span>
      )}
    </div>
  );
}

// The speed of the simulation, or the load of the bus.
function Rate({ state }: { state: PageState }) {
  const bus = state.bus.value;
  const simulation = state.simulation.value;
  const isConnected = state.isConnected.value;
  if (state.busSession.value !== null) {
    return (
      <div title="Share of the time in which frames are on the bus">
        <dt>bus load</dt>
        <dd data-testid="load">{isConnected && bus?.connected === true ? `${(100 * bus.load).toFixed(1)} %` : '–'}</dd>
      </div>
    );
  }
  const measured = simulation?.measured_factor;
  const isRunning = isConnected && simulation?.state === 'running';
  return (
    <div title="Simulated seconds in a second, measured">
      <dt>speed</dt>
      <dd>{isRunning && typeof measured === 'number' ? `× ${measured.toFixed(measured < 10 ? 2 : 1)}` : '–'}</dd>
    </div>
  );
}

function Figures({ state }: { state: PageState }) {
  const latency = state.latency.value;
  return (
    <dl class="figures">
      <Rate state={state} />
      <div title="From this page to the robot and back">
        <dt>latency</dt>
        <dd data-testid="latency">{latency === null ? '–' : `${latency < 10 ? latency.toFixed(1) : Math.round(latency)} ms`}</dd>
      </div>
    </dl>
  );
}

function Control({ app }: { app: Stores<'operations' | 'state'> }) {
  const { state } = app;
  if (!state.isConnected.value) {
    return <div class="control">not connected</div>;
  }
  const control = state.control.value;
  if (control === null) {
    return <div class="control" />; // the page may have control: the program has not said it yet
  }
  const other = state.otherHolder.value;
  const isAsking = control.request?.client === state.client.value;
  const take = () => void app.operations.tell('control.take', {});
  const release = () => void app.operations.tell('control.release', {});
  if (state.isHolder.value) {
    return (
      <div class="control has" data-testid="control">
        <span>You have control</span>
        <button type="button" onClick={release} title="Others can take control then (C)">
          Release
        </button>
      </div>
    );
  }
  const who = other === null ? 'Nobody has control' : `${other} has control${control.away ? ', but is away' : ''}`;
  const isFree = other === null || control.away;
  return (
    <div class="control" data-testid="control">
      <span>{isAsking ? `Asked ${other ?? 'the holder'} …` : who}</span>
      <button
        type="button"
        class="primary"
        disabled={isAsking}
        onClick={take}
        title="Only one viewer changes the robot at a time. Taking control moves nothing. (C)"
      >
        {isFree ? 'Take control' : 'Ask for control'}
      </button>
    </div>
  );
}

function PageButton({ app, page, title, number }: { app: Stores<'shownPage'>; page: PageName; title: string; number: number }) {
  return (
    <button
      type="button"
      aria-current={app.shownPage.value === page ? 'page' : undefined}
      onClick={() => (app.shownPage.value = page)}
      title={`${title} (${number})`}
    >
      {title}
    </button>
  );
}

export function TopBar({ app }: { app: Stores<'operations' | 'shownPage' | 'state' | 'stop'> }) {
  // If there are only recordings, there is nothing to stop until one of them is continued, or modules are on an open bus.
  const isAlone = app.state.isAlone.value;
  const hasBus = (app.state.modules.value?.bus ?? null) !== null;
  return (
    <header class="top-bar">
      <nav aria-label="Pages">
        {!isAlone && <PageButton app={app} page="live" title="Live" number={1} />}
        <PageButton app={app} page="recordings" title="Recordings" number={2} />
        {app.state.hasMake.value && <PageButton app={app} page="make" title="Make" number={3} />}
        {app.state.hasModules.value && <PageButton app={app} page="modules" title="Modules" number={4} />}
      </nav>
      <RobotName state={app.state} />
      <Figures state={app.state} />
      <Control app={app} />
      <PageTools
        documentation={
          <DocumentationLink state={app.state} to="index.html" isButton label="Documentation">
            {documentationIcon}
          </DocumentationLink>
        }
      />
      {(!isAlone || hasBus) && <StopArea stop={app.stop} isSimulation={app.state.robot.value?.kind === 'simulation'} />}
    </header>
  );
}
