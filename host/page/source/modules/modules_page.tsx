// The page Modules: the bus, the modules on it, and what can be done with them.
import { useEffect } from 'preact/hooks';
import { BusBar } from './bus_bar.js';
import { DoctorPart } from './doctor_part.js';
import { FlashPart } from './flash_part.js';
import { JobCard } from './job_card.js';
import { ModulePart } from './module_part.js';
import { ModuleTable } from './module_table.js';
import { ModulesApp, taskNames, type ModulesStores, type TaskName } from './modules_app.js';
import { PlacesPart } from './places_part.js';
import { RecoverPart } from './recover_part.js';
import { SettingsPart } from './settings_part.js';

let modules: ModulesApp | null = null; // the only one of the page; it stays when another page is shown

const taskTitles: Record<TaskName, string> = {
  module: 'Module',
  places: 'Places',
  flash: 'Flash',
  recover: 'Recover',
  settings: 'Settings',
  doctor: 'What is wrong?',
};

function TaskTabs({ app }: { app: ModulesApp }) {
  return (
    <div class="tabs" role="tablist" aria-label="Tasks">
      {taskNames.map((name, i) => (
        <button
          key={name}
          type="button"
          role="tab"
          id={`task-${name}`}
          aria-selected={app.task.value === name}
          aria-controls="modules-task"
          tabIndex={app.task.value === name ? 0 : -1}
          onClick={() => (app.task.value = name)}
          onKeyDown={(event) => {
            const by = event.key === 'ArrowRight' ? 1 : event.key === 'ArrowLeft' ? -1 : 0;
            if (by === 0) return;
            event.preventDefault();
            const next = taskNames[(i + by + taskNames.length) % taskNames.length] as TaskName;
            app.task.value = next;
            document.getElementById(`task-${next}`)?.focus();
          }}
        >
          {taskTitles[name]}
        </button>
      ))}
    </div>
  );
}

function Task({ app }: { app: ModulesApp }) {
  switch (app.task.value) {
    case 'module':
      return <ModulePart app={app} />;
    case 'places':
      return <PlacesPart app={app} />;
    case 'flash':
      return <FlashPart app={app} />;
    case 'recover':
      return <RecoverPart app={app} />;
    case 'settings':
      return <SettingsPart app={app} />;
    case 'doctor':
      return <DoctorPart app={app} />;
  }
}

// Below a long table a task is not in sight.
function useReveal(app: ModulesApp): void {
  const revealed = app.revealed.value;
  useEffect(() => {
    const tabs = revealed === 0 ? null : document.querySelector('.modules-tasks');
    if (tabs !== null && tabs.getBoundingClientRect().top > innerHeight / 2) tabs.scrollIntoView({ block: 'start' });
  }, [revealed]);
}

export function ModulesPage({ app: page }: { app: ModulesStores }) {
  modules ??= new ModulesApp(page);
  const app = modules;
  useReveal(app);
  if (app.modules.value === null) return <p class="wait">This program has no modules.</p>;
  return (
    <div class="modules">
      <BusBar app={app} />
      <JobCard app={app} />
      {app.isOpen.value && (
        <>
          <ModuleTable app={app} />
          <div class="modules-tasks">
            <TaskTabs app={app} />
            <section class="panel modules-panel" role="tabpanel" id="modules-task" aria-labelledby={`task-${app.task.value}`}>
              <Task app={app} />
            </section>
          </div>
        </>
      )}
    </div>
  );
}
