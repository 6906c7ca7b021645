// The legend of a map. It follows the theme of the page, so it is not where the colours are computed.
import { chartTheme, colourOf } from '../../panels/chart_theme.js';
import { isDark } from '../../view/theme.js';
import { shortNumber } from './search_text.js';

// The colours of a range of values.
export function ColourLegend({ range }: { range: readonly [number, number] }) {
  const theme = chartTheme(isDark.value);
  const steps = 12;
  const colours = Array.from({ length: steps + 1 }, (_, i) => colourOf(range[0] + (i / steps) * (range[1] - range[0]), range, theme));
  return (
    <span class="colour-legend" data-testid="colour-legend">
      {shortNumber(range[0], 3)} <i aria-hidden="true" style={{ background: `linear-gradient(to right, ${colours.join(', ')})` }} /> {shortNumber(range[1], 3)}
    </span>
  );
}
