// The picture of a sweep: a line or a map. The mouse and the arrow keys go from cell to cell; a click or Enter chooses one.
import { useEffect, useRef } from 'preact/hooks';
import type { OpenedSweep } from '../../wire/messages.js';
import { ColourLegend } from '../search/colour_legend.js';
import { keepDrawn } from '../search/keep_drawn.js';
import type { ChosenSweep } from './chosen_sweep.js';
import { cellAt, drawPicture } from './picture_drawing.js';
import { bestCell, meanRange, variedQuantities, type Cells } from './sweep_cells.js';
import { cellName, cellText } from './sweep_text.js';

interface Measured {
  name: string;
  unit: string;
  higherIsBetter: boolean;
}

function Legend({ cells, measure, isMap, hasBest }: { cells: Cells; measure: string; isMap: boolean; hasBest: boolean }) {
  const range = meanRange(cells);
  const marks = (
    <>
      {hasBest && <i class={isMap ? 'frame-mark' : 'ring-mark'} aria-hidden="true" />} {hasBest && 'best'} <b class="problem">×</b> no run has a value {isMap && <b class="problem">▪</b>} {isMap && 'some runs have none'}
    </>
  );
  if (!isMap) {
    return (
      <p class="hint legend-line">
        <i class="dot point" aria-hidden="true" /> mean of {measure}, with its standard deviation over the seeds {marks}
      </p>
    );
  }
  return (
    <p class="hint legend-line">
      {measure}{' '}
      {range !== null && <ColourLegend range={range} />}{' '}
      {marks}
    </p>
  );
}

export function SweepPicture({ chosen, opened, cells, measure }: { chosen: ChosenSweep; opened: OpenedSweep; cells: Cells; measure: Measured }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const axes = variedQuantities(opened);
  const [first, second] = axes;
  const title = measure.unit === '' ? measure.name : `${measure.name} (${measure.unit})`;
  const isPictured = first !== undefined && axes.length <= 2;
  useEffect(() => {
    if (!isPictured) return;
    return keepDrawn(
      canvas.current as HTMLCanvasElement,
      () => void [chosen.cells.value, chosen.number.value, chosen.pointed.value],
      (context, size, theme) => {
        const now = chosen.cells.peek();
        if (now === null) return;
        const best = bestCell(now, measure.higherIsBetter);
        drawPicture(context, { cells: now, axes, measure: title, best, chosen: chosen.number.peek(), pointed: chosen.pointed.peek() }, size, theme);
      },
    );
  }, [opened, title, measure.higherIsBetter]);
  const best = bestCell(cells, measure.higherIsBetter);
  const bestLine = best !== null && (
    <p data-testid="best-cell">
      Best: {cellName(opened, best)}: {cellText(cells, best, measure.unit)}{' '}
      <button type="button" onClick={() => chosen.choose(best)}>
        Show the best
      </button>
    </p>
  );
  if (!isPictured) return <>{bestLine}</>;
  const pointAt = (event: MouseEvent) => {
    const box = (canvas.current as HTMLCanvasElement).getBoundingClientRect();
    return cellAt(axes, box, { x: event.clientX - box.left, y: event.clientY - box.top });
  };
  const rows = second?.values.length ?? 1;
  const move = (event: KeyboardEvent) => {
    const steps: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    const step = steps[event.key];
    const from = chosen.pointed.peek() ?? chosen.number.peek() ?? best ?? 0;
    if (event.key === 'Enter') chosen.choose(from);
    if (step === undefined && event.key !== 'Enter') return;
    event.preventDefault();
    event.stopPropagation();
    if (step === undefined) return;
    const column = Math.max(0, Math.min(first.values.length - 1, Math.floor(from / rows) + step[0]));
    const row = Math.max(0, Math.min(rows - 1, (from % rows) + step[1]));
    chosen.pointed.value = column * rows + row;
  };
  const pointed = chosen.pointed.value;
  const told = pointed ?? chosen.number.value;
  return (
    <div class="sweep-picture">
      <Legend cells={cells} measure={title} isMap={second !== undefined} hasBest={best !== null} />
      <div
        role="application"
        tabIndex={0}
        class="sweep-frame"
        aria-label={`${second === undefined ? 'Line' : 'Map'}: ${title} over ${axes.map(({ name }) => name).join(' and ')}. The arrow keys go from cell to cell, Enter shows the gait. The same values are in the table below.`}
        data-testid="sweep-picture"
        onKeyDown={move}
        onPointerMove={(event) => (chosen.pointed.value = pointAt(event))}
        onPointerLeave={() => (chosen.pointed.value = null)}
        onClick={(event) => {
          const cell = pointAt(event);
          if (cell !== null) chosen.choose(cell);
        }}
      >
        <canvas ref={canvas} aria-hidden="true" />
      </div>
      <p role="status" class="cell-text" data-testid="cell-text">
        {told === null ? 'Point at a cell, or use the arrow keys, to read its value.' : `${cellName(opened, told)}: ${cellText(cells, told, measure.unit)}`}
      </p>
      {bestLine}
    </div>
  );
}
