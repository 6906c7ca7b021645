// The values of one parameter as a row of bars, one for each joint.
//   drag up and down: the bar's value     Shift and drag across: all bars get the value under the pointer
//   arrows: left and right choose, up and down change     digits, Enter: type a value     double click: back to the file
import { useSignal } from '@preact/signals';
import { useLayoutEffect } from 'preact/hooks';
import { addFront } from '../view/front.js';
import type { Stores } from '../view/robot_view.js';
import { formatRaw, parseValue, placeName, setWord, sliderStep } from '../state/parameter_values.js';
import type { Parameter } from '../wire/messages.js';

// Bars are as high as the cell at the limits of the slider; zero is where it is between them.
function share(raw: number, parameter: Parameter): number {
  const span = parameter.maximum - parameter.minimum || 1;
  return Math.max(0, Math.min(1, (raw - parameter.minimum) / span));
}

export function JointCells({ app, parameter }: { app: Stores<'newGesture' | 'selection' | 'sets' | 'state'>; parameter: Parameter }) {
  const isHolder = app.state.isHolder.value;
  const robot = app.state.robot.value;
  const gesture = useSignal(0);
  const isDragging = useSignal(false);
  const current = useSignal(0);
  const typed = useSignal<string | null>(null);
  const isTyping = typed.value !== null;
  useLayoutEffect(
    () => (isTyping ? addFront({ isOpen: () => true, close: () => (typed.value = null) }) : undefined),
    [isTyping],
  );
  const count = parameter.joints.length;
  const nameOf = (i: number) => robot?.joints[parameter.joints[i] ?? 0]?.name ?? `joint ${i + 1}`;
  const step = sliderStep(parameter);
  const zero = share(0, parameter);

  const set = (i: number, value: number) => {
    const low = parameter.minimum * parameter.scale;
    const high = parameter.maximum * parameter.scale;
    app.sets.set([setWord(parameter, nameOf(i), Math.max(low, Math.min(high, value)))], gesture.value);
  };
  const setFromPointer = (box: DOMRect, event: PointerEvent) => {
    const height = 1 - (event.clientY - box.top) / box.height;
    const raw = parameter.minimum + Math.max(0, Math.min(1, height)) * (parameter.maximum - parameter.minimum);
    const i = event.shiftKey ? Math.floor(((event.clientX - box.left) / box.width) * count) : current.value;
    set(Math.max(0, Math.min(count - 1, i)), Math.round((raw * parameter.scale) / step) * step);
  };
  const accept = (text: string) => {
    const value = parseValue(text, parameter);
    typed.value = null;
    if (typeof value === 'string') {
      app.state.addNotice('warning', `${parameter.name} of ${nameOf(current.value)}: ${value}`);
    } else {
      gesture.value = app.newGesture();
      set(current.value, value);
    }
  };
  const onKey = (event: KeyboardEvent) => {
    const moves: Record<string, number> = { ArrowLeft: -1, ArrowRight: 1, Home: -count, End: count };
    const steps: Record<string, number> = { ArrowUp: 1, ArrowDown: -1, PageUp: 10, PageDown: -10 };
    const move = moves[event.key];
    const change = steps[event.key];
    if (move !== undefined) {
      current.value = Math.max(0, Math.min(count - 1, current.value + move));
      (event.currentTarget as HTMLElement).querySelectorAll<HTMLElement>('[role="slider"]')[current.value]?.focus();
    } else if (change !== undefined && isHolder) {
      if (!event.repeat) gesture.value = app.newGesture();
      set(current.value, (parameter.wanted[current.value] ?? 0) * parameter.scale + change * step);
    } else if (isHolder && typed.value === null && (/^[0-9.\-]$/.test(event.key) || event.key === 'Enter')) {
      typed.value = event.key === 'Enter' ? formatRaw(parameter.wanted[current.value] ?? 0, parameter) : event.key;
    } else {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
  };

  return (
    <div class="cells-frame">
      <div
        class="cells"
        role="group"
        aria-label={`${parameter.name.replace(/_/g, ' ')} of each joint`}
        onKeyDown={onKey}
        onPointerDown={(event) => {
          const cell = (event.target as Element).closest<HTMLElement>('[data-cell]');
          if (!isHolder || cell === null || event.button !== 0) return;
          current.value = Number(cell.dataset['cell']);
          gesture.value = app.newGesture();
          isDragging.value = true;
          event.currentTarget.setPointerCapture(event.pointerId);
        }}
        onPointerMove={(event) => {
          if (isDragging.value) setFromPointer(event.currentTarget.getBoundingClientRect(), event);
        }}
        onPointerUp={() => (isDragging.value = false)}
        onPointerCancel={() => (isDragging.value = false)}
        onPointerLeave={() => (app.selection.hoveredJoint.value = null)}
      >
        {parameter.joints.map((joint, i) => {
          const wanted = parameter.wanted[i] ?? 0;
          const confirmed = parameter.confirmed[i] ?? 0;
          const bar = share(wanted, parameter);
          const text = formatRaw(wanted, parameter);
          const isChanged = wanted !== parameter.file[i];
          const isHovered = app.selection.hoveredJoint.value === joint;
          const classes = ['cell', isChanged && 'changed', wanted !== confirmed && 'pending', isHovered && 'hovered'];
          const fileText = formatRaw(parameter.file[i] ?? 0, parameter);
          return (
            <div
              key={joint}
              class={classes.filter(Boolean).join(' ')}
              role="slider"
              tabIndex={i === current.value ? 0 : -1}
              data-cell={i}
              data-takes-number
              aria-label={nameOf(i)}
              aria-disabled={!isHolder}
              aria-valuemin={parameter.minimum * parameter.scale}
              aria-valuemax={parameter.maximum * parameter.scale}
              aria-valuenow={Number(text)}
              aria-valuetext={`${text} ${parameter.unit}`}
              title={`${nameOf(i)}: wanted ${text}, confirmed ${formatRaw(confirmed, parameter)}, file ${fileText} ${parameter.unit}`}
              onFocus={() => (current.value = i)}
              onPointerEnter={() => (app.selection.hoveredJoint.value = joint)}
              onDblClick={() => app.sets.reset([placeName(parameter, nameOf(i))])}
            >
              <i
                class="bar"
                style={{ bottom: `${100 * Math.min(bar, zero)}%`, height: `${Math.max(4, 100 * Math.abs(bar - zero))}%` }}
              />
              <i class="file-mark" style={{ bottom: `${100 * share(parameter.file[i] ?? 0, parameter)}%` }} />
            </div>
          );
        })}
      </div>
      {typed.value !== null && (
        <input
          type="text"
          class="cell-input"
          inputMode="decimal"
          aria-label={`${parameter.name} of ${nameOf(current.value)}`}
          value={typed.value}
          ref={(element) => element?.focus()}
          onInput={(event) => (typed.value = event.currentTarget.value)}
          onKeyDown={(event) => {
            if (event.key === 'Enter') accept(event.currentTarget.value);
            if (event.key === 'Tab') typed.value = null;
          }}
          onBlur={() => (typed.value = null)}
        />
      )}
    </div>
  );
}
