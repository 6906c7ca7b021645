// Searches, their results and candidates in words.
import type { OpenedSearch, SearchCandidate, SearchEntry, SearchResult } from '../../wire/messages.js';

const minute = 60;
const hour = 3600;

// A text of a declaration as a sentence.
export function sentence(text: string): string {
  return text === '' ? '' : `${text[0]!.toUpperCase()}${text.slice(1)}${/[.!?]$/.test(text) ? '' : '.'}`;
}

const rounding = 1e-12; // what is smaller is left over from a sum that is 0

export function shortNumber(value: number, digits = 5): string {
  if (Math.abs(value) < rounding) return '0';
  return Number.isFinite(value) ? String(Number(value.toPrecision(digits))) : '–';
}

export function withUnit(value: number | null, unit: string, digits = 5): string {
  return value === null || Number.isNaN(value) ? '–' : `${shortNumber(value, digits)}${unit === '' ? '' : ` ${unit}`}`;
}

// 12,345; of very large numbers the size: 1.1·10^11.
export function countText(count: number): string {
  if (count < 1e7) return Math.round(count).toString().replace(/\B(?=(\d{3})+$)/g, ',');
  const power = Math.floor(Math.log10(count));
  return `${(count / 10 ** power).toFixed(1)}·10^${power}`;
}

export function durationText(seconds: number): string {
  if (seconds < 10) return `${Math.max(1, Math.round(seconds))} s`;
  if (seconds < 2 * minute) return `${Math.round(seconds)} s`;
  if (seconds < 2 * hour) return `${Math.round(seconds / minute)} min`;
  if (seconds < 48 * hour) return `${Math.floor(seconds / hour)} h ${Math.round((seconds % hour) / minute)} min`;
  return `${Math.round(seconds / 24 / hour)} days`;
}

export function evaluationsText({ made, planned }: Pick<SearchEntry, 'made' | 'planned'>): string {
  return planned === null ? countText(made) : `${countText(made)} of ${countText(planned)}`;
}

const stateTexts: Record<SearchEntry['state'], string> = {
  running: 'running',
  stopping: 'stopping …',
  ended: 'ended',
  interrupted: 'interrupted',
  unreadable: 'cannot be read',
  unread: 'reading …',
};

export function isRead({ state }: Pick<SearchEntry, 'state'>): boolean {
  return state !== 'unread' && state !== 'unreadable';
}

export function stateText({ state }: Pick<SearchEntry, 'state'>): string {
  return stateTexts[state];
}

// One line: the state, how far it is, and why it ended.
export function progressText(entry: SearchEntry): string {
  if (!isRead(entry)) return stateText(entry);
  const left = entry.left_s === null ? '' : `, ${durationText(entry.left_s)} left`;
  const ending = entry.ending === null || entry.ending === '' ? '' : `: ${entry.ending}`;
  return `${stateText(entry)}, ${evaluationsText(entry)} evaluations${left}${ending}`;
}

// Whether a search can go on, and with the number of evaluations that it has.
export function resumeKind({ state, made, planned }: SearchEntry): 'none' | 'as it is' | 'with more' {
  if (state !== 'ended' && state !== 'interrupted') return 'none';
  return state === 'ended' || (planned !== null && made >= planned) ? 'with more' : 'as it is';
}

// "amplitude:J1 and J2 are at the highest value of their ranges".
function boundText(bounds: SearchResult['at_bounds'], bound: 'lowest' | 'highest'): string[] {
  const names = bounds.filter((each) => each.bound === bound).map(({ dimension }) => dimension);
  if (names.length === 0) return [];
  const [are, ranges] = names.length === 1 ? ['is', 'its range'] : ['are', 'their ranges'];
  return [`${names.join(', ')} ${are} at the ${bound} value of ${ranges}: a wider range may give more.`];
}

// What a search has found, in a few sentences.
export function resultLines(result: SearchResult, { objectives, engine }: Pick<OpenedSearch, 'objectives' | 'engine'>): string[] {
  const objective = objectives[0];
  const unit = objective?.unit ?? '';
  const isJudged = result.judge !== undefined && result.judge !== null && result.judge !== engine;
  const judge = isJudged ? ` in ${result.judge!.toUpperCase()}` : '';
  const fresh = result.confirmations.find(({ number }) => number === result.best_number);
  const inSearch = result.best_search_scores[objective?.name ?? ''];
  const lines: string[] = [];
  if (fresh !== undefined && fresh.runs > 1 && result.confirmed_mean !== null) {
    const spread = result.confirmed_standard_deviation;
    lines.push(
      `The best is candidate ${result.best_number}: ${withUnit(result.confirmed_mean, unit, 7)}, the mean of ${fresh.runs} fresh runs${judge}` +
        `${spread === null ? '' : ` (standard deviation ${shortNumber(spread, 2)}, worst ${shortNumber(fresh.worst)})`}` +
        `${inSearch === undefined ? '' : `; in the search it had ${withUnit(inSearch, unit)}`}.`,
    );
  } else {
    const searched = isJudged && inSearch !== undefined ? `; in the search it had ${withUnit(inSearch, unit)} (${engine})` : '';
    lines.push(`The best is candidate ${result.best_number}: ${withUnit(result.best_score, unit, 7)}${judge}${searched}.`);
  }
  if (result.baseline !== null) {
    const { score, failure, moved } = result.baseline;
    const gain = result.gain_percent === null ? '' : ` The gain is ${result.gain_percent.toFixed(1)} %.`;
    lines.push(score === null ? `The scenario's own values have no score: ${failure ?? 'the run failed'}.` : `The scenario's own values had ${withUnit(score, unit)}.${gain}`);
    if (result.better_than_baseline === false) lines.push('No candidate was better than that.');
    for (const { dimension, scenario, baseline } of moved) {
      lines.push(`The scenario's ${dimension} = ${String(scenario)} is not among the values of the search: ${String(baseline)} took its place.`);
    }
  }
  lines.push(...boundText(result.at_bounds, 'highest'), ...boundText(result.at_bounds, 'lowest'));
  const failed = result.failed ?? 0;
  if (failed > 0) lines.push(`${countText(failed)} ${failed === 1 ? 'evaluation has' : 'evaluations have'} failed.`);
  return lines;
}

// What a person must know of an evaluation beside its numbers.
export function candidateRemarks(candidate: SearchCandidate, hasBaseline: boolean): string[] {
  return [
    ...(hasBaseline && candidate.number === 0 ? ['The values that the scenario had.'] : []),
    ...(candidate.failure === null ? [] : [`It failed: ${candidate.failure}`]),
    ...(candidate.given_up ? ['It was given up before its time was over: its score is extrapolated.'] : []),
    ...(candidate.reused ? ['The same values were evaluated before.'] : []),
  ];
}
