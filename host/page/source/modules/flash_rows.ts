// How far each module is with its image. The document has the newest event of each name only: what has ended before stays here.
import type { FlashOutcome, FlashProgress, FlashVerdict, ModuleJob } from '../wire/messages.js';
import { resultOf } from '../wire/module_messages.js';

export interface Advance {
  part: number; // 0 to 1
  text: string;
  isGood: boolean | null; // null: it goes on
}

export interface KnownAdvance {
  job: number;
  bySerial: ReadonlyMap<number, Advance>;
}

export function advanceWith(known: KnownAdvance | null, job: ModuleJob): KnownAdvance {
  const bySerial = new Map(known?.job === job.number ? known.bySerial : []);
  const going = job.latest.progress?.modules ?? [];
  const ended = job.latest.ended?.modules ?? [];
  // An event `ended` is about the modules of the progress before it: those that now make progress are others, or begin anew.
  const isNewer = (module: FlashProgress) => !ended.some(({ serial }) => serial === module.serial) || module.part < 1;
  for (const module of ended) bySerial.set(module.serial, outcomeOf(module));
  for (const module of going) {
    const isOver = bySerial.get(module.serial)?.isGood != null;
    if (!isOver && isNewer(module)) bySerial.set(module.serial, { part: module.part, text: module.state, isGood: null });
  }
  return { job: job.number, bySerial };
}

function outcomeOf({ outcome, good }: FlashOutcome): Advance {
  return { part: 1, text: outcome ?? '', isGood: good };
}

// What a person must know beside the rows: settings that are others now, nodes that do not answer.
export function flashWarnings(job: ModuleJob | null): string[] {
  const result = resultOf(job, 'flash');
  const changed = result?.modules.flatMap(({ node, changed_settings }) => (changed_settings ?? []).map((line) => `node ${node}: ${line}`)) ?? [];
  const silent = result?.silent_nodes ?? [];
  return [...changed, ...(silent.length === 0 ? [] : [`No answer from node ${silent.join(', ')}: Recover looks what it has.`])];
}

export interface FlashRow extends FlashVerdict {
  advance: Advance | null;
  now: string | null; // version that runs in the end
}

export function flashRows(job: ModuleJob | null, known: KnownAdvance | null): FlashRow[] {
  const result = resultOf(job, 'flash');
  const verdicts = job?.kind === 'flash' ? (job.latest.verdicts?.modules ?? []) : [];
  if (result !== null) {
    return result.modules.map((module) => ({
      ...module,
      advance: result.dry_run || module.outcome === null ? null : outcomeOf(module),
      now: module.now?.version ?? null,
    }));
  }
  return verdicts.map((verdict) => ({
    ...verdict,
    advance: (known !== null && known.job === job?.number ? known.bySerial.get(verdict.serial) : undefined) ?? null,
    now: null,
  }));
}
