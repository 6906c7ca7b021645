// The touch sensors of a module as dots: filled while pressed. From the tail to the head.
import type { ModuleRow } from './module_rows.js';
import { sensorsOf, touchText } from './row_text.js';

export function TouchDots({ row }: { row: ModuleRow }) {
  if (row.touch === null) return <span title="The sensors are not read while the robot moves.">–</span>;
  const touch = row.touch;
  return (
    <span class="touch-dots" role="img" aria-label={touchText(row)}>
      {sensorsOf(row).map((bit) => (
        <i key={bit} class={(touch >> bit) & 1 ? 'pressed' : ''} />
      ))}
    </span>
  );
}
