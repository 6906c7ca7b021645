// What the 3D view plays while a candidate is chosen: the present gait of the draft, and the candidate beside it. Of several
// candidates and drafts in a row the newest is shown.
import { computed, effect, signal, untracked } from '@preact/signals-core';
import type { DraftDocument, Operations, RobotDocument } from '../../wire/messages.js';
import { decodeMotion, MotionPair, type Motion } from './motion.js';
import { NewestAnswer } from './newest_answer.js';
import type { SearchHost } from './search_host.js';

const delay = 200; // milliseconds

// A candidate of a search or a cell of a sweep whose motion is wanted, and the number of joints of its robot.
export type WantedMotion = { name: string; joints: number } & ({ run: number; number: number } | { cell: number });

export class MotionLoader {
  // Why nothing is played; null: it is, or comes.
  readonly problem = computed(() => {
    if (this.wanted.value === null) return null;
    return this.otherRobot.value ?? this.candidates.failure.value ?? this.drafts.failure.value;
  });
  // Whether a motion is still to come.
  readonly isWaiting = computed(() => this.wanted.value !== null && (this.candidates.isWaiting.value || this.drafts.isWaiting.value));
  private readonly wanted = signal<WantedMotion | null>(null);
  private readonly otherRobot = computed(() => {
    const wanted = this.wanted.value;
    const [joints, own] = [wanted?.joints, this.host.draftRobot.value?.joints.length];
    if (wanted === null || joints === undefined || own === undefined || joints === own) return null;
    return `The robot of this ${'cell' in wanted ? 'sweep' : 'search'} has ${joints} joints, that of the draft ${own}: they are not shown together.`;
  });
  private readonly candidates: NewestAnswer<WantedMotion, Motion>;
  private readonly drafts: NewestAnswer<DraftDocument, Motion>;
  private asked: WantedMotion | null = null; // of the candidates

  constructor(
    private readonly host: SearchHost,
    after: (ms: number, action: () => void) => void,
  ) {
    const { operations } = host.page;
    const askSearch = async (words: Operations['search.motion']) => decodeMotion((await operations.ask('search.motion', words)) as ArrayBuffer);
    const askSweep = async (words: Operations['sweep.motion']) => decodeMotion((await operations.ask('sweep.motion', words)) as ArrayBuffer);
    this.candidates = new NewestAnswer((wanted) => ('cell' in wanted ? askSweep({ name: wanted.name, cell: wanted.cell }) : askSearch({ name: wanted.name, run: wanted.run, number: wanted.number })), after, 0);
    this.drafts = new NewestAnswer(() => askSearch({}), after, delay);
    // The draft moves otherwise after each change. What was refused is asked again when the part is shown again.
    effect(() => {
      const draft = this.host.draft.value;
      const wanted = this.wanted.value;
      if (wanted === null || !this.host.isSearchShown.value || draft === null || this.otherRobot.value !== null) return;
      untracked(() => {
        if (this.drafts.last.peek()?.question !== draft || this.drafts.failure.peek() !== null) this.drafts.want(draft);
        if (this.asked !== wanted || this.candidates.failure.peek() !== null) this.candidates.want(wanted);
        this.asked = wanted;
      });
    });
    effect(() => {
      const wanted = this.host.isSearchShown.value && this.otherRobot.value === null ? this.wanted.value : null;
      const candidate = this.candidates.last.value;
      const draft = this.drafts.last.value;
      const robot = this.host.draftRobot.value;
      this.candidates.isWaiting.value;
      untracked(() => this.show(wanted, candidate?.question === wanted ? (candidate?.answer ?? null) : null, draft?.answer ?? null, robot));
    });
  }

  want(wanted: WantedMotion | null): void {
    if (JSON.stringify(wanted) !== JSON.stringify(this.wanted.peek())) this.wanted.value = wanted;
  }

  private show(wanted: WantedMotion | null, candidate: Motion | null, draft: Motion | null, robot: RobotDocument | null): void {
    const { motion } = this.host;
    const before = motion.peek();
    // The one before stays until the next is there.
    if (wanted !== null && candidate === null && this.candidates.isWaiting.peek() && before?.robot === robot) return;
    // A draft with other joints comes before its motion.
    if (wanted === null || candidate === null || robot === null || draft?.joints !== candidate.joints || candidate.joints !== robot.joints.length) {
      motion.value = null;
      return;
    }
    if (before?.candidate === candidate && before.draft === draft && before.robot === robot) return;
    // A change of the draft does not begin it anew.
    const isSame = before?.candidate === candidate;
    motion.value = new MotionPair(draft, candidate, robot, isSame ? before.time.cursor.peek() : 0, isSame ? before.time.isPlaying.peek() : true);
  }
}
