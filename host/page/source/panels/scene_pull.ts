// Dragging a link in the 3D view turns its joint, while the robot is held. The worker finds the link and the angle.
import type { RobotView } from '../view/robot_view.js';
import type { ToScene } from '../scene/scene_messages.js';
import { positionOf } from './joint_values.js';

const degree = Math.PI / 180;

export class ScenePull {
  // asked: the worker has not yet said which joint it is.
  private state: 'none' | 'asked' | 'pulling' = 'none';
  private joint = 0;
  private start = 0; // angle of the joint when it was grabbed, in degrees

  constructor(
    private readonly app: RobotView,
    private readonly send: (message: ToScene) => void,
  ) {}

  get isPossible(): boolean {
    return this.app.poses?.isPossible === true;
  }

  // Begins a pull; x and y are those of the messages to the worker.
  press(x: number, y: number): void {
    if (this.isPossible) {
      this.state = 'asked';
      this.send({ kind: 'grab_joint', x, y });
    }
  }

  // Moves the pull. Returns false if the movement is not for a joint, so that it turns the view.
  move(x: number, y: number): boolean {
    if (this.state === 'pulling') {
      this.send({ kind: 'drag_joint', x, y });
    }
    return this.state !== 'none';
  }

  release(): void {
    this.state = 'none';
  }

  grabbed(joint: number | null): void {
    const start = joint === null ? null : positionOf(this.app, joint);
    if (this.state !== 'asked' || joint === null || start === null) {
      this.state = 'none';
      return;
    }
    this.state = 'pulling';
    this.joint = joint;
    this.start = start;
    this.app.selection.hoveredJoint.value = joint;
  }

  dragged(angle: number): void {
    const joints = this.app.state.robot.peek()?.joints ?? [];
    const joint = joints[this.joint];
    if (this.state !== 'pulling' || joint === undefined || !this.isPossible) {
      this.state = 'none';
      return;
    }
    const wanted = Math.min(joint.upper, Math.max(joint.lower, this.start + angle / degree));
    this.app.poses?.move(new Map([[this.joint, wanted]]), joints.length);
  }
}
