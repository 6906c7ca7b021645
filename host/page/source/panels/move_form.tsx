// A place for the robot, in numbers.
import { useSignal } from '@preact/signals';
import type { MoveTool } from '../state/move_tool.js';
import { formatNumber, parseNumber } from '../state/parameter_values.js';

const decimals = 4; // decimals of a length in metres

type Field = 'x' | 'y' | 'z' | 'turn';

export function MoveForm({ mover }: { mover: MoveTool }) {
  const problem = useSignal<string | null>(null);
  // The typed numbers stay until the robot has arrived: the program sends the head's place several times a second.
  const typed = useSignal<Partial<Record<Field, string>>>({});
  const head = mover.head ?? [0, 0, 0];
  const shown: Record<Field, string> = {
    x: formatNumber(head[0], decimals),
    y: formatNumber(head[1], decimals),
    z: formatNumber(head[2], decimals),
    turn: '0',
    ...typed.value,
  };
  const input = (name: Field, size: number, title?: string) => (
    <input
      type="text"
      inputMode="decimal"
      name={name}
      size={size}
      title={title}
      value={shown[name]}
      onInput={(event) => (typed.value = { ...typed.peek(), [name]: event.currentTarget.value })}
    />
  );
  const submit = async (event: SubmitEvent) => {
    event.preventDefault();
    const place = (['x', 'y', 'z', 'turn'] as const).map((name) => parseNumber(shown[name]));
    problem.value = place.find((value) => typeof value === 'string') ?? null;
    if (problem.value === null) {
      const [x, y, z, turn] = place as [number, number, number, number];
      if (await mover.moveTo({ position: [x, y, z], turn })) typed.value = {};
    }
  };
  return (
    <form class="move-form" onSubmit={(event) => void submit(event)} aria-label="Place of the head">
      {(['x', 'y', 'z'] as const).map((axis) => (
        <label key={axis}>
          {axis} {input(axis, 7)} m
        </label>
      ))}
      <label>turn {input('turn', 4, 'To the left, about the vertical')}°</label>
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
