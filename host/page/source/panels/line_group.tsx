// One plot: up to eight lines, their names with values, and the choice of lines.
import { useSignal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import { onFrame } from '../view/frame_clock.js';
import type { RobotView } from '../view/robot_view.js';
import { formatMeasured } from '../state/parameter_values.js';
import { mostLines, type Line, type LineGroup } from '../state/signal_selection.js';
import { isDark } from '../view/theme.js';
import { chartTheme } from './chart_theme.js';
import { addIcon, closeIcon } from './icons.js';
import { comparedValueOf, valueOf } from './joint_values.js';
import { LinePlot } from './line_plot.js';
import { signalTitle, valueName } from './value_names.js';

const readoutPeriod = 100; // milliseconds

// With a second recording the text has both values.
function valueText(app: RobotView, { signal, index }: Line): string {
  const { rowsAtCursor, time } = app;
  const tick = time.shownTick(app.newestTick);
  const text = (value: number | null) => (value === null ? '–' : formatMeasured(value));
  const own = text(valueOf(app, signal, index, Math.min(rowsAtCursor.end - 1, rowsAtCursor.rowAtTick(tick))));
  return (app.compared?.peek() ?? null) === null ? own : `${own} | ${text(comparedValueOf(app, signal, index, tick))}`;
}

function LineChip({ app, group, line, colour }: { app: RobotView; group: LineGroup; line: Line; colour: string }) {
  const value = useRef<HTMLSpanElement>(null);
  useEffect(() => {
    let last = 0;
    return onFrame((now) => {
      if (now - last > readoutPeriod && value.current !== null) {
        last = now;
        value.current.textContent = valueText(app, line);
      }
    });
  }, [line]);
  const signal = app.state.telemetry.value?.signals.find((candidate) => candidate.name === line.signal);
  const name = valueName(app.state.robot.value, signal, line.index);
  const title = `${line.signal.replace(/_/g, ' ')} ${name}`;
  return (
    <li
      onPointerEnter={() => (app.selection.hoveredJoint.value = line.index)}
      onPointerLeave={() => (app.selection.hoveredJoint.value = null)}
    >
      <i class="swatch" style={{ background: colour }} />
      {title} <span class="value" ref={value} /> {signal?.unit}
      <button
        type="button"
        class="icon-button"
        aria-label={`Remove ${title}`}
        onClick={() => app.selection.toggle(group.number, line)}
      >
        {closeIcon}
      </button>
    </li>
  );
}

function LineChoice({ app, group }: { app: RobotView; group: LineGroup }) {
  const signals = app.state.telemetry.value?.signals ?? [];
  const chosen = useSignal('angle');
  const signal = signals.find((candidate) => candidate.name === chosen.value) ?? signals[0];
  if (signal === undefined) {
    return null;
  }
  const isFull = group.lines.length >= mostLines;
  const has = (index: number) => group.lines.some((line) => line.signal === signal.name && line.index === index);
  return (
    <div class="line-choice">
      <label>
        Signal{' '}
        <select value={signal.name} onChange={(event) => (chosen.value = event.currentTarget.value)}>
          {signals.map((candidate) => (
            <option key={candidate.name} value={candidate.name}>
              {signalTitle(candidate)}
            </option>
          ))}
        </select>
      </label>
      <div class="joint-buttons" role="group" aria-label={`Lines of ${signal.name}`}>
        {Array.from({ length: signal.count }, (_, index) => (
          <button
            type="button"
            key={index}
            aria-pressed={has(index)}
            disabled={isFull && !has(index)}
            onClick={() => app.selection.toggle(group.number, { signal: signal.name, index })}
          >
            {valueName(app.state.robot.value, signal, index)}
          </button>
        ))}
      </div>
      <span class="hint">
        {isFull ? `${mostLines} lines are the most; remove one first.` : `${group.lines.length} of ${mostLines} lines`}
      </span>
    </div>
  );
}

export function LineGroupView({ app, group }: { app: RobotView; group: LineGroup }) {
  const holder = useRef<HTMLDivElement>(null);
  const isChoosing = useSignal(group.lines.length === 0);
  const colours = chartTheme(isDark.value).lines;
  useEffect(() => {
    const plot = new LinePlot(app, holder.current as HTMLDivElement, group.lines, isDark.value);
    return () => plot.dispose();
  }, [group.lines, isDark.value, app.compared?.value]);
  return (
    <div class="line-group">
      <div class="panel-head">
        <ul class="line-chips" aria-label="Lines">
          {group.lines.map((line, i) => (
            <LineChip
              key={`${line.signal}/${line.index}`}
              app={app}
              group={group}
              line={line}
              colour={colours[i] ?? 'currentColor'}
            />
          ))}
        </ul>
        <button
          type="button"
          aria-expanded={isChoosing.value}
          onClick={() => (isChoosing.value = !isChoosing.value)}
          title="Choose signals and joints"
        >
          {addIcon} Lines
        </button>
        <button
          type="button"
          class="icon-button"
          aria-label="Remove this plot"
          title="Remove this plot"
          onClick={() => app.selection.removeGroup(group.number)}
        >
          {closeIcon}
        </button>
      </div>
      {isChoosing.value && <LineChoice app={app} group={group} />}
      <div class="plot" ref={holder} data-testid="plot" />
      {group.lines.length === 0 && <p class="hint">No lines yet: choose a signal and joints above.</p>}
    </div>
  );
}
