// STOP, and what it has done.
import { describeStop, isConfirmed, type StopControl } from '../state/stop_report.js';

interface Properties {
  stop: StopControl;
  isSimulation: boolean; // Esc has another meaning there
  ofClass?: boolean; // all robots of a class stop
}

export function StopArea({ stop, isSimulation, ofClass = false }: Properties) {
  const report = stop.report.value;
  const keys = isSimulation ? 'Space outside text fields' : 'Esc, or Space outside text fields';
  return (
    <div class="stop-area">
      <span class={`stop-report ${report.state === 'stopped' && !isConfirmed(report) ? 'unconfirmed' : report.state}`} role="status" data-testid="stop-report">
        {describeStop(report, ofClass ? ' robots' : '')}
      </span>
      <div class="stop-place">
        <button
          type="button"
          class="stop"
          aria-describedby="stop-note"
          aria-keyshortcuts={isSimulation ? 'Space' : 'Escape Space'}
          title={`Stops ${ofClass ? 'all robots of the class' : 'the robot'} at once: ${keys}. This does not replace a power switch.`}
          onPointerDown={(event) => {
            // STOP acts at the press, not at the release; the click that follows has no second effect.
            if (event.button === 0) stop.press();
          }}
          onClick={(event) => {
            // detail is 0 for a click by the keyboard or by a program that reads the screen.
            if (event.detail === 0) stop.press();
          }}
        >
          STOP <kbd>{isSimulation ? 'Space' : 'Esc'}</kbd>
        </button>
        <span id="stop-note" class="stop-note" title="This does not replace a power switch.">
          does not replace a power switch
        </span>
      </div>
    </div>
  );
}
