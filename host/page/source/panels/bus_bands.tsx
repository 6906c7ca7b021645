// Bands of a robot on a bus: facts that the user must read before any other step.
import type { Stores } from '../view/robot_view.js';
import { moduleName } from '../state/module_text.js';

export function BusBands({ app }: { app: Stores<'state'> }) {
  const { state } = app;
  const bus = state.bus.value;
  const session = state.busSession.value;
  const age = state.freshness.age.value;
  if (session === null) {
    return null;
  }
  const withoutPower = session.state === 'off' || session.state === 'stopping' || session.state === 'failed';
  const unconfirmed = (bus?.modules ?? []).filter((module) => withoutPower && module.stop_confirmed === false);
  const names = unconfirmed.map((module) => moduleName(module, state.robot.value)).join(', ');
  return (
    <>
      {bus?.connected === false && (
        <div class="band lost" role="alert" data-testid="bus-band">
          No connection to the bus {bus.address}: {bus.problem ?? 'no reason is known.'} Modules that receive nothing from a host stop by themselves.
        </div>
      )}
      {bus?.connected === true && bus.problem !== null && (
        <div class="band question" role="alert" data-testid="bus-band">
          {bus.problem}
        </div>
      )}
      {bus?.connected === true && bus.other_host && (
        <div class="band question" role="alert">
          Another host drives modules on {bus.address}. End it before you give power.
        </div>
      )}
      {names !== '' && (
        <div class="band lost" role="alert" data-testid="unconfirmed-band">
          STOP is not confirmed by {names}. Use the power switch.
        </div>
      )}
      {age !== null && (
        <div class="band question" role="alert" data-testid="age-band">
          Last heard {age} s ago: what you see is old.
        </div>
      )}
    </>
  );
}
