// The touch sensors of one module, large: each gets a tick when it was pressed and released.
import type { ModuleRow } from './module_rows.js';
import type { ModulesApp } from './modules_app.js';
import { sensorNames, sensorsOf } from './row_text.js';
import { touchVerdict } from './touch_watch.js';

const texts = { 'not yet': 'not yet', pressed: 'now let it go', stuck: 'stuck, or in contact', works: '✓ works' };

export function TouchTest({ app, row }: { app: ModulesApp; row: ModuleRow }) {
  const watch = app.seenTouch.value.get(row.node) ?? null;
  const sensors = sensorsOf(row);
  const verdicts = sensors.map((bit) => touchVerdict(watch, bit));
  const isComplete = verdicts.every((verdict) => verdict === 'works');
  const stuck = sensors.filter((_, place) => verdicts[place] === 'stuck').map((bit) => sensorNames[bit]);
  return (
    <section class="touch-test" aria-label="Touch test" data-testid="touch-test">
      <h3>Touch test</h3>
      <p class="hint">
        {row.live?.silent === true ? 'The module is silent: its sensors are not read.' : row.touch === null ? 'The sensors are read while nothing moves.' : 'Lift the module, then press each sensor and let it go. It lights at once, and gets a tick when it was released, pressed and released.'}
        {!row.hasFrontSensors && ' The sensors of the link in front belong to the next module, but for the one at the head.'}
      </p>
      <ul>
        {sensors.map((bit, place) => {
          const isPressed = (((row.touch ?? 0) >> bit) & 1) === 1;
          const verdict = verdicts[place] ?? 'not yet';
          return (
            <li key={bit} class={`${isPressed ? 'pressed' : ''} ${verdict === 'works' ? 'seen' : ''}`} data-sensor={bit}>
              <span>{sensorNames[bit]}</span>
              <strong>{isPressed && verdict !== 'stuck' ? 'pressed' : texts[verdict]}</strong>
            </li>
          );
        })}
      </ul>
      <div class="fields">
        <span role="status" class={isComplete ? 'verdict good' : stuck.length > 0 ? 'problem' : 'hint'}>
          {isComplete ? 'All sensors work.' : stuck.length > 0 ? `Pressed since the test began: ${stuck.join('; ')}. If nothing touches it, the sensor or its cable is stuck.` : ''}
        </span>
        {watch !== null && (
          <button type="button" onClick={() => app.forgetTouch(row.node)} title="Takes the ticks away">
            Begin anew
          </button>
        )}
      </div>
    </section>
  );
}
