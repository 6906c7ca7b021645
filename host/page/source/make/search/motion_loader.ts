// What the 3D view plays while a candidate is chosen: the present gait of the draft, and the candidate beside it. Of several
// candidates and drafts in a row the newest is shown.
import { computed, effect, signal, untracked } from '@preact/signals-core';
import type { DraftDocument } from '../../wire/messages.js';
import { decodeMotion, MotionPair, type Motion } from './motion.js';
import { NewestAnswer } from './newest_answer.js';
import type { SearchHost } from './search_host.js';

const delay = 200; // milliseconds

// A candidate whose motion is wanted. `tick`: microseconds, of its scenario.
export interface WantedMotion {
  name: string;
  run: number;
  number: number;
  tick: number;
}

export class MotionLoader {
  readonly problem = computed(() => {
    if (this.wanted.value === null) return null;
    return this.candidates.failure.value ?? this.drafts.failure.value ?? this.otherRobot.value;
  });
  // Whether a motion is still to come.
  readonly isWaiting = computed(() => this.wanted.value !== null && (this.candidates.isWaiting.value || this.drafts.isWaiting.value));
  private readonly wanted = signal<WantedMotion | null>(null);
  private readonly otherRobot = signal<string | null>(null);
  private readonly candidates: NewestAnswer<WantedMotion, Motion>;
  private readonly drafts: NewestAnswer<DraftDocument, Motion>;

  constructor(
    private readonly host: SearchHost,
    after: (ms: number, action: () => void) => void,
  ) {
    const { operations } = host.page;
    this.candidates = new NewestAnswer(
      async ({ name, run, number, tick }) => decodeMotion((await operations.ask('search.motion', { name, run, number })) as ArrayBuffer, tick),
      after,
      0,
    );
    this.drafts = new NewestAnswer(async ({ run }) => decodeMotion((await operations.ask('draft.motion', {})) as ArrayBuffer, 1000 * run.tick), after, delay);
    // The draft moves otherwise after each change. What was refused is asked again when the part is shown again.
    effect(() => {
      const draft = this.host.draft.value;
      const wanted = this.wanted.value;
      if (wanted === null || !this.host.isSearchShown.value || draft === null) return;
      untracked(() => {
        if (this.drafts.last.peek()?.question !== draft || this.drafts.failure.peek() !== null) this.drafts.want(draft);
        if (this.candidates.failure.peek() !== null) this.candidates.want(wanted);
      });
    });
    effect(() => {
      const wanted = this.host.isSearchShown.value ? this.wanted.value : null;
      const candidate = this.candidates.last.value;
      const draft = this.drafts.last.value;
      const robot = this.host.draftRobot.value;
      this.candidates.isWaiting.value;
      untracked(() => this.show(wanted, candidate?.question === wanted ? (candidate?.answer ?? null) : null, draft?.answer ?? null, robot));
    });
  }

  want(wanted: WantedMotion | null): void {
    if (JSON.stringify(wanted) === JSON.stringify(this.wanted.peek())) return;
    if (wanted !== null) this.candidates.want(wanted);
    this.wanted.value = wanted;
  }

  private show(wanted: WantedMotion | null, candidate: Motion | null, draft: Motion | null, robot: SearchHost['draftRobot']['value']): void {
    const { motion } = this.host;
    const before = motion.peek();
    const joints = robot?.joints.length;
    this.otherRobot.value =
      candidate !== null && joints !== undefined && candidate.joints !== joints
        ? `The robot of this search has ${candidate.joints} joints, that of the draft ${joints}: they are not shown together.`
        : null;
    // The one before stays until the next is there.
    if (wanted !== null && candidate === null && this.candidates.isWaiting.peek() && before?.robot === robot) return;
    if (wanted === null || candidate === null || draft === null || robot === null || candidate.joints !== joints || draft.joints !== joints) {
      motion.value = null;
      return;
    }
    if (before?.candidate === candidate && before.draft === draft && before.robot === robot) return;
    // A change of the draft does not begin it anew.
    const isSame = before?.candidate === candidate;
    motion.value = new MotionPair(draft, candidate, robot, isSame ? before.time.cursor.peek() : 0, isSame ? before.time.isPlaying.peek() : true);
  }
}
