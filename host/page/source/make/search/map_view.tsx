// The map of gaits of a search with MAP-Elites, and the trials of adaptations on it. The mouse and the arrow keys go from cell to
// cell; a click or Enter chooses the gait of a cell.
import { useEffect, useMemo, useRef } from 'preact/hooks';
import type { Adaptation, OpenedSearch } from '../../wire/messages.js';
import { bestTrial, trialCells, trialRow } from './adaptation_trials.js';
import type { ChosenSearch, ShownRows } from './chosen_search.js';
import { ColourLegend } from './colour_legend.js';
import type { GaitMap } from './gait_map.js';
import { keepDrawn } from './keep_drawn.js';
import { drawMap, filledCellAt, nextFilledCell, scoreRange } from './map_drawing.js';
import { countText, shortNumber, withUnit } from './search_text.js';

const steps: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

interface Shown {
  chosen: ChosenSearch;
  opened: OpenedSearch;
  rows: ShownRows;
  map: GaitMap;
}

function cellText({ opened, map }: Shown, cell: number): string {
  const row = map.elites.get(cell);
  const { name, unit } = opened.objectives[0]!;
  return `Cell ${map.nameOf(cell)}: ${row === undefined ? 'empty' : `${name} ${withUnit(map.scoreOf(cell), unit)}, candidate ${row}`}`;
}

function MapChart({ shown }: { shown: Shown }) {
  const { chosen, opened, map } = shown;
  const canvas = useRef<HTMLCanvasElement>(null);
  const { name, maximise } = opened.objectives[0]!;
  const chosenCell = () => [...map.elites].find(([, row]) => row === chosen.number.peek())?.[0] ?? null;
  useEffect(
    () =>
      keepDrawn(
        canvas.current as HTMLCanvasElement,
        () => void [chosen.shownCount.value, chosen.number.value, chosen.pointedCell.value, chosen.adaptation.value],
        (context, size, theme) => {
          const adaptation = chosen.adaptation.peek();
          const trials = adaptation === null ? [] : trialCells(adaptation, map, maximise);
          drawMap(context, { map, trials, chosen: chosenCell(), pointed: chosen.pointedCell.peek() }, maximise, size, theme);
        },
      ),
    [map],
  );
  const choose = (cell: number | null) => {
    const row = cell === null ? undefined : map.elites.get(cell);
    if (row !== undefined) chosen.chooseCandidate(row);
  };
  const cellAt = (event: MouseEvent) => {
    const box = (canvas.current as HTMLCanvasElement).getBoundingClientRect();
    return filledCellAt(map, maximise, box, { x: event.clientX - box.left, y: event.clientY - box.top });
  };
  const move = (event: KeyboardEvent) => {
    const step = steps[event.key];
    const from = chosen.pointedCell.peek() ?? chosenCell() ?? map.elites.keys().next().value ?? null;
    if (from === null || (step === undefined && event.key !== 'Enter')) return;
    event.preventDefault();
    event.stopPropagation();
    if (step === undefined) choose(from);
    else chosen.pointedCell.value = nextFilledCell(map, from, step);
  };
  const told = chosen.pointedCell.value ?? chosenCell();
  const axes = map.axes.map((axis) => axis.name);
  const adaptation = chosen.adaptation.value;
  return (
    <div
      role="application"
      tabIndex={0}
      class="sweep-frame"
      aria-label={`Map of gaits: ${name} over ${axes.join(' and ')}${adaptation === null ? '' : `, with the trials of ${adaptation.name}`}. The arrow keys go from cell to cell, Enter shows the gait.`}
      aria-description={told === null ? undefined : cellText(shown, told)}
      data-testid="gait-map"
      onKeyDown={move}
      onPointerMove={(event) => (chosen.pointedCell.value = cellAt(event))}
      onPointerLeave={() => (chosen.pointedCell.value = null)}
      onClick={(event) => choose(cellAt(event))}
    >
      <canvas ref={canvas} aria-hidden="true" />
    </div>
  );
}

function TrialTable({ shown: { chosen, opened, rows: { store } }, adaptation }: { shown: Shown; adaptation: Adaptation }) {
  const { name, unit, maximise } = opened.objectives[0]!;
  const measure = unit === '' ? name : `${name} (${unit})`;
  const best = bestTrial(adaptation, maximise);
  const rows = useMemo(() => adaptation.trials.map((trial) => trialRow(trial, store)), [adaptation, store, store.clears, store.count]);
  return (
    <div class="table-frame candidates" tabIndex={0} role="group" aria-label="Table of trials">
      <table data-testid="trials">
        <caption class="hint">
          {adaptation.robot}: {adaptation.trials.length === 0 ? 'no trial yet' : 'what was expected of the gaits, and what was measured'}. Choose a trial to see how its gait moves.
          {adaptation.diagnosis !== null && <p data-testid="diagnosis">Probable damage: {adaptation.diagnosis}.</p>}
        </caption>
        <thead>
          <tr>
            <th scope="col">trial</th>
            <th scope="col">cell</th>
            <th scope="col">expected {measure}</th>
            <th scope="col">measured {measure}</th>
          </tr>
        </thead>
        <tbody>
          {adaptation.trials.map((trial, place) => {
            const row = rows[place]!;
            const isChosen = row !== null && row === chosen.number.value;
            return (
              <tr key={place} class={isChosen ? 'chosen' : ''} onClick={() => row !== null && chosen.chooseCandidate(row)}>
                <th scope="row">
                  <button type="button" aria-pressed={isChosen} disabled={row === null} title={row === null ? 'No candidate of this search has these values.' : `Candidate ${row}`}>
                    {place + 1}
                  </button>
                  {place === best && <span class="hint"> best</span>}
                </th>
                <td>{trial.cell}</td>
                <td>
                  {shortNumber(trial.expected, 4)} ± {shortNumber(trial.deviation, 2)}
                </td>
                <td>{trial.failure === null ? shortNumber(trial.measured, 4) : `failed: ${trial.failure}`}</td>
              </tr>
            );
          })}
        </tbody>
      </table>
    </div>
  );
}

function Trials({ shown }: { shown: Shown }) {
  const { chosen } = shown;
  const { value: adaptations } = chosen.adaptations;
  const adaptation = chosen.adaptation.value;
  if (adaptations.length === 0) return null;
  return (
    <>
      <div class="fields">
        <label class="number-field" title="Adaptations of this project that have tried gaits of this map">
          <span>trials of</span>
          <select name="adaptation" value={adaptation?.name ?? ''} onChange={(event) => chosen.chooseAdaptation(event.currentTarget.value)}>
            <option value="">none</option>
            {adaptations.map(({ name }) => (
              <option key={name} value={name}>
                {name}
              </option>
            ))}
          </select>
        </label>
      </div>
      {adaptation !== null && <TrialTable shown={shown} adaptation={adaptation} />}
    </>
  );
}

export function MapView({ chosen, opened, rows }: Omit<Shown, 'map'>) {
  const { map } = rows;
  chosen.shownCount.value;
  chosen.number.value; // the cell of a candidate that another part has chosen
  if (map === null) return null;
  const shown = { chosen, opened, rows, map };
  const { name, unit } = opened.objectives[0]!;
  const range = scoreRange(map);
  const told = chosen.pointedCell.value;
  return (
    <div class="sweep-picture">
      <p class="hint legend-line" data-testid="map-legend">
        Map of gaits: {countText(map.elites.size)} of {countText(map.cellCount)} cells are filled. {unit === '' ? name : `${name} (${unit})`} {range !== null && <ColourLegend range={range} />}
        {map.axes.length > 2 && ' Of cells at one place the best is in front.'}
      </p>
      <MapChart shown={shown} />
      <p role="status" class="cell-text" data-testid="map-cell">
        {told === null ? 'Point at a cell, or use the arrow keys, to read its score.' : cellText(shown, told)}
      </p>
      <Trials shown={shown} />
    </div>
  );
}
