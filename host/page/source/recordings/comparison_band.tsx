// One line about two compared recordings, and the way back to a single one.
import type { OpenedRecording } from './opened_recording.js';
import { comparisonText, wayText } from './compared_recording.js';

export function ComparisonBand({ opened }: { opened: OpenedRecording }) {
  const compared = opened.compared.value;
  if (compared === null) {
    return null;
  }
  const { failure } = compared;
  const comparison = compared.comparison.value;
  const { difference, motion } = comparison;
  const ticks = [difference?.tick, motion?.difference?.tick].filter((tick) => tick !== undefined);
  const first = Math.min(...ticks);
  return (
    <div class={`band ${failure === null ? 'info' : 'lost'} comparison`} role="status" data-testid="comparison">
      <span>
        <strong>{compared.name}</strong> (dashed, <i class="mark ghost" /> translucent): {failure ?? `${comparisonText(comparison)}; ${wayText(comparison)}`}
      </span>
      {ticks.length > 0 && (
        <button type="button" onClick={() => opened.time.pick(first)} title="The time cursor goes to the first difference">
          To tick {first}
        </button>
      )}
      <button type="button" onClick={() => (opened.compared.value = null)} title="Ends the comparison (D)">
        End
      </button>
    </div>
  );
}
