// The touch sensors of one module, large: each gets a tick when it was pressed once.
import type { ModuleRow } from './module_rows.js';
import type { ModulesApp } from './modules_app.js';
import { sensorNames, sensorsOf } from './row_text.js';

export function TouchTest({ app, row }: { app: ModulesApp; row: ModuleRow }) {
  const seen = app.seenTouch.value.get(row.node) ?? 0;
  const sensors = sensorsOf(row);
  const isComplete = sensors.every((bit) => (seen >> bit) & 1);
  return (
    <section class="touch-test" aria-label="Touch test" data-testid="touch-test">
      <h3>Touch test</h3>
      <p class="hint">
        {row.touch === null ? 'The sensors are read while nothing moves.' : 'Press each sensor. It lights at once, and gets a tick.'}
        {!row.hasFrontSensors && ' The sensors of the link in front belong to the next module, but for the one at the head.'}
      </p>
      <ul>
        {sensors.map((bit) => {
          const isPressed = (((row.touch ?? 0) >> bit) & 1) === 1;
          const wasSeen = ((seen >> bit) & 1) === 1;
          return (
            <li key={bit} class={`${isPressed ? 'pressed' : ''} ${wasSeen ? 'seen' : ''}`} data-sensor={bit}>
              <span>{sensorNames[bit]}</span>
              <strong>{isPressed ? 'pressed' : wasSeen ? '✓ seen' : 'not yet'}</strong>
            </li>
          );
        })}
      </ul>
      <div class="fields">
        <span role="status" class={isComplete ? 'verdict good' : 'hint'}>
          {isComplete ? 'All sensors were seen.' : ''}
        </span>
        {seen !== 0 && (
          <button type="button" onClick={() => app.forgetTouch(row.node)} title="Takes the ticks away">
            Begin anew
          </button>
        )}
      </div>
    </section>
  );
}
