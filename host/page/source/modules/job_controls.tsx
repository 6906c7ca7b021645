// Buttons and boxes of the page Modules. A button that cannot be pressed says why.
import type { ComponentChildren } from 'preact';
import type { ModulesApp } from './modules_app.js';

interface Properties {
  app: ModulesApp;
  title: string;
  run(): void;
  isPrimary?: boolean;
  needsControl?: boolean; // false: the job only reads
  obstacle?: string | null; // a further reason why it cannot begin
  children: ComponentChildren;
}

export function JobButton({ app, title, run, isPrimary = false, needsControl = true, obstacle = null, children }: Properties) {
  const why = app.obstacle(needsControl) ?? obstacle;
  return (
    <button type="button" class={isPrimary ? 'primary' : ''} disabled={why !== null} title={why ?? title} onClick={run}>
      {children}
    </button>
  );
}

// The reason why no job can begin, for those who cannot see titles.
export function JobObstacle({ app, needsControl = true }: { app: ModulesApp; needsControl?: boolean }) {
  const why = app.obstacle(needsControl);
  return why === null ? null : <p class="hint">{why}</p>;
}

interface Box {
  label: string;
  isOn: boolean;
  title?: string;
  isDisabled?: boolean;
  isHidden?: boolean; // the label is only for screen readers
  change(isOn: boolean): void;
}

export function CheckBox({ label, isOn, title, isDisabled = false, isHidden = false, change }: Box) {
  return (
    <label class="check-box" title={title}>
      <input
        type="checkbox"
        checked={isOn}
        disabled={isDisabled}
        aria-label={label}
        onChange={(event) => change(event.currentTarget.checked)}
        onKeyDown={(event) => {
          if (event.key === 'Enter') change(!isOn); // Space is STOP
        }}
      />
      {!isHidden && <span>{label}</span>}
    </label>
  );
}

// A table that scrolls by itself.
export function TableFrame({ label, children }: { label: string; children: ComponentChildren }) {
  return (
    <div class="table-frame" tabIndex={0} role="group" aria-label={label}>
      {children}
    </div>
  );
}
