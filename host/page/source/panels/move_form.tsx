// A place for the robot, in numbers.
import { useSignal } from '@preact/signals';
import type { MoveTool } from '../state/move_tool.js';
import { formatNumber, parseNumber } from '../state/parameter_values.js';

const decimals = 4; // of metres

export function MoveForm({ mover }: { mover: MoveTool }) {
  const problem = useSignal<string | null>(null);
  const head = mover.head ?? [0, 0, 0];
  const submit = (event: SubmitEvent) => {
    event.preventDefault();
    const fields = new FormData(event.currentTarget as HTMLFormElement);
    const typed = ['x', 'y', 'z', 'turn'].map((name) => parseNumber(String(fields.get(name) ?? '')));
    problem.value = typed.find((value) => typeof value === 'string') ?? null;
    if (problem.value === null) {
      const [x, y, z, turn] = typed as [number, number, number, number];
      void mover.moveTo({ position: [x, y, z], turn });
    }
  };
  return (
    <form class="move-form" onSubmit={submit} aria-label="Place of the head">
      {['x', 'y', 'z'].map((axis, i) => (
        <label key={axis}>
          {axis} <input type="text" inputMode="decimal" name={axis} size={7} value={formatNumber(head[i] ?? 0, decimals)} /> m
        </label>
      ))}
      <label>
        turn <input type="text" inputMode="decimal" name="turn" size={4} value="0" title="To the left, about the vertical" />°
      </label>
      <button type="submit">Put there</button>
      <p class="hint">Drag the robot; with Shift its height, with Ctrl its heading. Arrow keys, Page Up and Down do the same.</p>
      {problem.value !== null && (
        <p class="problem" role="alert">
          {problem.value}
        </p>
      )}
    </form>
  );
}
