// The slider for all joints. Its way is that of state/slider_scale.ts, with marks at the ends of the useful range.
import { useSignal } from '@preact/signals';
import { SliderScale, type ScaledParameter } from '../state/slider_scale.js';
import { formatRaw } from '../state/parameter_values.js';
import type { Parameter } from '../wire/messages.js';

interface Props {
  parameter: ScaledParameter & Pick<Parameter, 'unit'>;
  value: number; // in the unit
  label: string;
  describedBy: string | undefined;
  isDisabled: boolean;
  begin(): void; // a drag, or a press of a key
  set(value: number): void;
  reset(): void;
}

const stepsOfKeys: Record<string, number> = {
  ArrowLeft: -1,
  ArrowDown: -1,
  ArrowRight: 1,
  ArrowUp: 1,
  PageDown: -10,
  PageUp: 10,
  Home: -Infinity,
  End: Infinity,
};

export function ParameterSlider({ parameter, value, label, describedBy, isDisabled, begin, set, reset }: Props) {
  const scale = new SliderScale(parameter);
  // The value while the slider is dragged, or a key is held down.
  const dragged = useSignal<number | null>(null);
  const shown = dragged.value ?? value;
  const change = (wanted: number) => {
    dragged.value = wanted;
    set(wanted);
  };
  const unit = parameter.unit === '' ? '' : ` ${parameter.unit}`;
  return (
    <span class="slider">
      <input
        type="range"
        aria-label={label}
        aria-describedby={describedBy}
        min={0}
        max={1}
        step="any"
        value={scale.positionOf(shown)}
        aria-valuetext={`${formatRaw(Math.round(shown / parameter.scale), parameter)}${unit}`}
        disabled={isDisabled}
        onPointerDown={begin}
        onKeyDown={(event) => {
          // The browser's steps are parts of the way; these are steps of the value.
          const steps = stepsOfKeys[event.key];
          if (steps === undefined || event.altKey || event.ctrlKey || event.metaKey) return;
          event.preventDefault();
          if (!event.repeat) begin();
          change(scale.stepped(shown, steps));
        }}
        onKeyUp={() => (dragged.value = null)}
        onBlur={() => (dragged.value = null)}
        onInput={(event) => change(scale.valueAt(Number(event.currentTarget.value)))}
        onChange={() => (dragged.value = null)}
        onDblClick={reset}
        title="All joints. The marks are the ends of the usual range. Double click: back to the file’s value"
      />
      {scale.marks.map((position) => (
        <i key={position} class="useful-end" aria-hidden="true" style={{ '--position': String(position) }} />
      ))}
    </span>
  );
}
