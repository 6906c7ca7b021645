// Moves a paused robot to another place: by a drag in the 3D view, by keys, or by typed numbers.
import { computed, signal } from '@preact/signals-core';
import { compose, fromAxisAngle, type Pose, type Vector } from '../geometry/quaternion.js';
import type { SessionDocument } from '../wire/messages.js';
import type { PageState } from './page_state.js';

// The place to which the head's frame moves, in metres, and the angle in degrees by which the robot turns to the left about
// the vertical there.
export interface RobotPlace {
  position: Vector;
  turn: number;
}

// A place that was requested from the program. `session`: the document at its confirmation, which still has the old place
// of the head.
interface AskedPlace {
  position: Vector;
  session: SessionDocument | null;
  isPending: boolean;
}

const smallestMove = 1e-4; // metres and degrees: a press without a drag

export class MoveTool {
  readonly isOn = signal(false);
  readonly isPossible = computed(() => this.state.isHolder.value && this.state.simulation.value?.state === 'paused');
  readonly isActive = computed(() => this.isOn.value && this.isPossible.value);
  // The place while the robot is dragged; the program has not been asked yet.
  readonly preview = signal<RobotPlace | null>(null);
  private start: Vector | null = null; // place of the head when the drag began
  private asked: AskedPlace | null = null; // the last request

  // `ask`: requests a move; its result is null if the move was refused.
  constructor(
    private readonly state: PageState,
    private readonly ask: (place: RobotPlace) => Promise<unknown>,
  ) {}

  get session(): PageState['simulation'] {
    return this.state.simulation;
  }

  // The head now; null before the first document.
  get head(): Vector | null {
    const head = this.state.simulation.value?.head;
    return head === undefined ? null : [head[0], head[1], head[2]];
  }

  // Starts from the place of the robot after the requested moves, because keys come faster than documents.
  begin(): void {
    const { asked } = this;
    const isOnTheWay = asked !== null && (asked.isPending || asked.session === this.state.session.peek());
    this.start = isOnTheWay ? asked.position : this.head;
  }

  drag(offset: Vector, turn: number): void {
    if (this.start !== null && this.isActive.peek()) {
      const [x, y, z] = this.start;
      this.preview.value = { position: [x + offset[0], y + offset[1], z + offset[2]], turn };
    }
  }

  async drop(): Promise<void> {
    const place = this.preview.peek();
    const start = this.start;
    this.start = null;
    if (place !== null && start !== null) {
      const way = Math.hypot(...place.position.map((value, axis) => value - (start[axis] as number)));
      if (way > smallestMove || Math.abs(place.turn) > smallestMove) {
        await this.moveTo(place);
      }
      if (this.preview.peek() === place) this.preview.value = null;
    }
  }

  // Moves the robot by an offset and an angle, as a key does.
  async step(offset: Vector, turn: number): Promise<void> {
    this.begin();
    this.drag(offset, turn);
    await this.drop();
  }

  // Moves the robot. Returns false if that is not possible, or was refused.
  async moveTo(place: RobotPlace): Promise<boolean> {
    if (!this.isActive.peek()) {
      return false;
    }
    const asked: AskedPlace = { position: place.position, session: null, isPending: true };
    this.asked = asked;
    const answer = await this.ask(place);
    Object.assign(asked, { isPending: false, session: this.state.session.peek() });
    if (answer === null && this.asked === asked) this.asked = null;
    return answer !== null;
  }
}

// The head's pose at a place.
export function placedHead(head: Pose, place: RobotPlace): Pose {
  const turn = fromAxisAngle([0, 0, 1], (place.turn * Math.PI) / 180);
  const turned = compose({ position: [0, 0, 0], orientation: turn }, { position: [0, 0, 0], orientation: head.orientation });
  return { position: place.position, orientation: turned.orientation };
}
