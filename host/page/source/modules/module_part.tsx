// The chosen module: its touch sensors, its potentiometer, its objects.
import { CalibrationView } from './calibration_view.js';
import { JobButton, JobObstacle } from './job_controls.js';
import { serialText } from './module_rows.js';
import type { ModulesApp } from './modules_app.js';
import { ObjectTables } from './object_tables.js';
import { stateText, troubleOf } from './row_text.js';
import { TouchTest } from './touch_test.js';

export function ModulePart({ app }: { app: ModulesApp }) {
  const row = app.chosenRow.value;
  const calibration = <CalibrationView app={app} />;
  if (row === null) {
    return (
      <>
        {calibration}
        <p class="hint">Choose a row of the table to see what the module has, to try its touch sensors, and to change its settings.</p>
      </>
    );
  }
  const trouble = troubleOf(row);
  const { node } = row;
  return (
    <>
      <div class="panel-head">
        <h2>
          Node {node}
          {row.joint !== null && `, ${row.joint.name}`}
        </h2>
        <span class="hint">
          {serialText(row.serial)}, {stateText(row)}
        </span>
        <span class="space" />
        <JobButton app={app} title="Measures the potentiometer at -90 and +90 degrees" run={() => void app.tell('modules.calibrate', { node })}>
          Calibrate …
        </JobButton>
        <JobButton app={app} needsControl={false} title="Reads its objects again" obstacle={app.objects.isReading.value ? 'It is being read.' : null} run={() => void app.objects.read()}>
          Read again
        </JobButton>
      </div>
      {trouble !== null && (
        <p class="problem">
          {trouble.text}. {trouble.advice}
        </p>
      )}
      {calibration}
      <TouchTest app={app} row={row} />
      <JobObstacle app={app} needsControl={false} />
      <ObjectTables app={app} />
    </>
  );
}
