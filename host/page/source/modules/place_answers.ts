// What a person says who looks at the table while one joint after the other moves.
import { computed, signal, type ReadonlySignal } from '@preact/signals-core';
import type { ActionList } from '../state/actions.js';
import type { Stores } from '../view/robot_view.js';
import { resultOf } from '../wire/module_messages.js';
import type { ModuleJob, ModulesDocument, PlacedModule } from '../wire/messages.js';
import { isRunning, placeWord } from './job_text.js';
import { PlaceView } from './place_view.js';
import type { QuestionAnswers } from './question_answers.js';

// What the places need of the page Modules.
export interface PlaceHost {
  readonly page: Stores<'startSceneWorker' | 'state'>;
  readonly job: ReadonlySignal<ModuleJob | null>;
  readonly modules: ReadonlySignal<ModulesDocument | null>;
  readonly task: ReadonlySignal<string>;
  readonly actions: ActionList;
  readonly answers: Pick<QuestionAnswers, 'answer' | 'obstacle'>;
}

export class PlaceAnswers {
  readonly typed = signal(''); // digits, or the name of a joint
  readonly run = computed(() => (this.host.job.value?.kind === 'assign' ? this.host.job.value : null));
  readonly question = computed(() => (isRunning(this.run.value) ? (this.run.value?.question ?? null) : null));
  // The modules whose joint is known, by the name of the joint.
  readonly placed = computed(() => placedModules(this.run.value));
  readonly view: PlaceView;

  constructor(private readonly host: PlaceHost) {
    const placedJoints = computed(() => {
      const joints = host.modules.value?.robot?.joints ?? [];
      return joints.flatMap(({ name }, i) => (this.placed.value.has(name) ? [i] : []));
    });
    this.view = new PlaceView(host.page.state, host.actions, () => host.page.startSceneWorker(), placedJoints, (joint) => {
      const name = host.modules.peek()?.robot?.joints[joint]?.name;
      if (name !== undefined && this.canPlace.peek()) this.answer(name);
    });
    this.addKeys();
  }

  // Whether a joint can be named now.
  readonly canPlace = computed(() => this.question.value?.question === 'joint' && this.host.answers.obstacle.value === null);

  answer(word: string): void {
    this.typed.value = '';
    void this.host.answers.answer(word);
  }

  answerTyped(): void {
    this.answer(placeWord(this.typed.peek(), this.host.modules.peek()?.robot?.joints ?? []));
  }

  // Digits and Enter are an answer wherever the focus is; else digits would show another page.
  private addKeys(): void {
    const isShown = () => this.question.value?.question === 'joint' && this.host.task.value === 'places';
    const digits = Array.from({ length: 10 }, (_, digit) => String(digit));
    this.host.actions.add(
      ...digits.map((digit) => ({
        id: `place_${digit}`,
        title: `The joint that has moved: digit ${digit}`,
        group: 'Robot' as const,
        keys: [digit],
        isShown,
        run: () => void (this.typed.value += digit),
      })),
      {
        id: 'place_answer',
        title: 'The joint that has moved: answer',
        group: 'Robot',
        keys: ['Enter'],
        isShown: () => isShown() && this.typed.value !== '',
        run: () => this.answerTyped(),
      },
    );
  }
}

export function placedModules(job: ModuleJob | null): Map<string, Pick<PlacedModule, 'node' | 'serial'>> {
  const placed = new Map<string, Pick<PlacedModule, 'node' | 'serial'>>();
  for (const { joint, node, serial } of resultOf(job, 'assign')?.joints ?? []) {
    if (node !== null && serial !== null) placed.set(joint, { node, serial });
  }
  if (placed.size > 0) return placed;
  for (const { joint, node, serial } of job?.latest.places?.modules ?? []) {
    if (joint !== null) placed.set(joint, { node, serial });
  }
  return placed;
}
