// Brings an image to modules: which one, to which, and how far each is.
import { useSignal } from '@preact/signals';
import { DocumentationLink } from '../panels/documentation_link.js';
import type { ModuleOperations } from '../wire/messages.js';
import { FlashTable } from './flash_table.js';
import { flashRows, flashWarnings } from './flash_rows.js';
import { ImageChoice, imageOf } from './image_choice.js';
import { CheckBox, JobButton, JobObstacle } from './job_controls.js';
import { isRunning } from './job_text.js';
import type { ModulesApp } from './modules_app.js';

export function FlashPart({ app }: { app: ModulesApp }) {
  const chosen = useSignal<string | null>(null);
  const onlyChecked = useSignal(false);
  const canary = useSignal(true);
  const forceBoard = useSignal(false);
  const allowDowngrade = useSignal(false);
  const image = imageOf(app.modules.value?.images ?? [], chosen.value);
  const checked = app.checkedList.value;
  const job = app.lastOf('flash');
  const rows = flashRows(job, app.flashAdvance.value);
  const refused = rows.filter(({ action }) => action === 'refuse').length;
  const warnings = flashWarnings(job);
  const obstacle = image === null ? 'There is no image.' : image.problem;
  const words = (dryRun: boolean): ModuleOperations['modules.flash'] => ({
    image: image?.file ?? '',
    nodes: onlyChecked.peek() ? checked : null,
    canary: canary.peek(),
    dry_run: dryRun,
    force_board: forceBoard.peek(),
    allow_downgrade: allowDowngrade.peek(),
  });
  const to = onlyChecked.value && checked !== null ? `nodes ${checked}` : 'all modules';
  return (
    <>
      <p class="hint">A module whose new program does not start well returns to the one before. Settings stay. <DocumentationLink state={app.page.state} to="flashing.html">Flashing</DocumentationLink></p>
      <div class="fields">
        <ImageChoice app={app} chosen={chosen} />
      </div>
      <div class="fields">
        <CheckBox
          label={checked === null ? 'only checked rows' : `only nodes ${checked}`}
          title="The boxes at the left of the table of modules"
          isDisabled={checked === null}
          isOn={onlyChecked.value && checked !== null}
          change={(isOn) => (onlyChecked.value = isOn)}
        />
        <CheckBox label="one module first" title="The others get the image only if it runs there" isOn={canary.value} change={(isOn) => (canary.value = isOn)} />
      </div>
      <div class="fields">
        <JobButton app={app} obstacle={obstacle} title="Says what would be done to each module, and sends nothing" run={() => void app.tell('modules.flash', words(true))}>
          Look what would be done
        </JobButton>
        <JobButton app={app} isPrimary obstacle={obstacle} title={`Brings the image to ${to}`} run={() => void app.tell('modules.flash', words(false))}>
          Flash {to}
        </JobButton>
        <JobObstacle app={app} />
      </div>
      {rows.length > 0 && <FlashTable rows={rows} isGoing={isRunning(job)} />}
      {warnings.map((text) => (
        <p key={text} class="problem">
          {text}
        </p>
      ))}
      {refused > 0 && (
        <p class="announcement">
          {refused === 1 ? 'One module is refused' : `${refused} modules are refused`}: the table has the reason. The options below force it.
        </p>
      )}
      <details open={forceBoard.value || allowDowngrade.value}>
        <summary>Modules that are refused</summary>
        <div class="fields">
          <CheckBox
            label="also on boards for which the image is not"
            title="Only for boards of your own that are compatible. A wrong board may not start."
            isOn={forceBoard.value}
            change={(isOn) => (forceBoard.value = isOn)}
          />
          <CheckBox
            label="also if the image is older"
            title="An older program may not know the settings of the module."
            isOn={allowDowngrade.value}
            change={(isOn) => (allowDowngrade.value = isOn)}
          />
        </div>
        <p class="hint">A program for another board may not start, and an older one may not know the settings of the module.</p>
      </details>
    </>
  );
}
