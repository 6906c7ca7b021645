// The charts of a search: its learning curve, a value against the score, and of two objectives the Pareto front.
import type { OpenedSearch, SearchObjective } from '../../wire/messages.js';
import { frontChart, learningCurve, valueChart } from './chart_content.js';
import type { ChosenSearch, ShownRows } from './chosen_search.js';
import type { Ranking } from './ranking.js';
import { ScoreChart, type Chart } from './score_chart.js';

function nameWithUnit({ name, unit }: { name: string; unit: string }): string {
  return unit === '' ? name : `${name} (${unit})`;
}

function axisName(objective: SearchObjective): string {
  return `${nameWithUnit(objective)}, ${objective.maximise ? 'higher' : 'lower'} is better`;
}

function FrontChart({ chosen, opened, rows }: { chosen: ChosenSearch; opened: OpenedSearch; rows: ShownRows }) {
  const { front, rankings } = rows;
  const [first, second] = opened.objectives;
  chosen.shownCount.value;
  const ranking = rankings[0];
  if (front === null || ranking === undefined || first === undefined || second === undefined) return null;
  const chart: Chart = {
    id: `${opened.name}/${rows.id}/front`,
    title: `Pareto front: ${axisName(second)}, over ${axisName(first)}, of each evaluation`,
    labels: { x: axisName(first), y: axisName(second) },
    maximise: second.maximise,
    follow: () => void [chosen.shownCount.value, chosen.number.value],
    content: () => frontChart({ store: rows.store, ranking, chosen: chosen.number.peek(), hasBaseline: opened.has_baseline }, front, [first.maximise, second.maximise]),
    choose: (row) => chosen.chooseCandidate(row),
  };
  return (
    <div class="front">
      <p class="hint legend-line">
        <i class="dot point" aria-hidden="true" /> evaluation <i class="dot front" aria-hidden="true" /> Pareto front: {front.rows.length} {front.rows.length === 1 ? 'candidate' : 'candidates'} that no other is better than in both
      </p>
      <ScoreChart chart={chart} testId="front-chart" />
    </div>
  );
}

export function SearchCharts({ chosen, opened, rows, ranking }: { chosen: ChosenSearch; opened: OpenedSearch; rows: ShownRows; ranking: Ranking }) {
  const objective = opened.objectives[ranking.objective]!;
  const score = nameWithUnit(objective);
  const dimension = Math.min(chosen.dimension.value, opened.dimensions.length - 1);
  const shown = opened.dimensions[dimension];
  const state = () => ({ store: rows.store, ranking, chosen: chosen.number.peek(), hasBaseline: opened.has_baseline });
  const common = {
    maximise: objective.maximise,
    follow: () => void [chosen.shownCount.value, chosen.number.value],
    choose: (row: number) => chosen.chooseCandidate(row),
  };
  const id = `${opened.name}/${rows.id}/${ranking.objective}`;
  const title = `Learning curve: the ${score} of each evaluation, and the best so far`;
  const curve: Chart = { ...common, id, title, labels: { x: 'evaluation', y: score }, content: () => learningCurve(state()) };
  const points: Chart | null = shown === undefined ? null : {
    ...common,
    id: `${id}/${dimension}`,
    title: `The ${score} of each evaluation over ${shown.name}`,
    labels: { x: nameWithUnit(shown), y: score },
    content: () => valueChart(state(), dimension, shown),
  };
  return (
    <div class="search-charts">
      <div>
        <p class="hint legend-line" aria-hidden="true">
          <i class="dot point" /> evaluation <i class="dot best" /> best so far <i class="dot failed" /> failed{opened.has_baseline && ' – – own values'}
        </p>
        <ScoreChart chart={curve} testId="learning-curve" />
      </div>
      {points !== null && (
        <div>
          <label class="number-field">
            <span>score over</span>
            <select value={String(dimension)} onChange={(event) => (chosen.dimension.value = Number(event.currentTarget.value))}>
              {opened.dimensions.map(({ name }, number) => (
                <option key={name} value={String(number)}>
                  {name}
                </option>
              ))}
            </select>
          </label>
          <ScoreChart chart={points} testId="value-chart" />
        </div>
      )}
      <FrontChart chosen={chosen} opened={opened} rows={rows} />
    </div>
  );
}
