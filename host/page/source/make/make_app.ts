// The stores of the page Make: the draft of the scenario, the chosen object, and the changes that are on their way.
import { computed, effect, signal, untracked } from '@preact/signals-core';
import { arrayOf, headingOf, outline, type Point } from '../geometry/outline.js';
import { compose, fromAxisAngle, invert, multiply, poseFromArray, type Pose, type Vector } from '../geometry/quaternion.js';
import type { PlacedObject } from '../scene/scene_messages.js';
import { ActionList } from '../state/actions.js';
import { openDialog, toggleDialog } from '../view/dialogs.js';
import { addFront } from '../view/front.js';
import type { Stores } from '../view/robot_view.js';
import type { Body, DraftDocument, NewScenario, Operations, RobotDocument, WorldObject } from '../wire/messages.js';
import { algorithmApp } from './algorithm/algorithm_app.js';
import { AlgorithmOffer } from './algorithm/algorithm_offer.js';
import { DraftChanges, refusalOf } from './draft_changes.js';
import { DraftView } from './draft_view.js';
import { freeDistance } from './free_place.js';
import { copyJoints, jointColumns, type JointPaste } from './joint_table.js';
import { OwnMesh } from './own_mesh.js';
import type { SearchHost } from './search/search_host.js';
import type { MeshFile } from './mesh_transfer.js';

export type MakeStores = Stores<'actions' | 'makeActions' | 'newGesture' | 'operations' | 'shownPage' | 'startSceneWorker' | 'state' | 'wantedScenario'>;

// The parts of the draft that can be shown beside the drawings.
export const partNames = ['robot', 'behaviour', 'algorithm', 'world', 'run', 'search'] as const;
export type PartName = (typeof partNames)[number];

// What is dragged, and where it is now. The program gets the next step when it has answered the one before.
interface Drag {
  gesture: number;
  head: Pose; // of the robot, when the drag began
  start: Vector; // of the robot in the file, when the drag began
  moved: ReadonlyMap<number, Pose>; // objects; -1: the start of the robot
}

export const startOfRobot = -1;
export const groundSize = 40; // metres; what is larger is ground, which is not dragged or chosen in a drawing
const copyStep = [0.5, 0, 0] as const; // metres
const mostPasted = 50_000; // characters; the program refuses more than 48 KiB, and a message has a limit

// What an object looks like.
export function bodyOf(robot: RobotDocument, object: WorldObject): Body | undefined {
  return (object.moves ? robot.objects : robot.terrain)?.[object.index];
}

export class MakeApp {
  readonly chosenObjects = signal<readonly number[]>([]); // of a group one
  readonly drag = signal<Drag | null>(null);
  readonly panel = signal<'none' | 'new' | 'open' | 'save' | 'algorithm'>('none'); // what is open below the bar
  readonly newStep = signal(0); // of the panel New
  readonly part = signal<PartName>('world');
  readonly chosenJoints = signal<readonly number[]>([]); // kernel order
  readonly discards = signal(false); // changes of a draft without files may be lost
  readonly refit = signal(0); // counts the times when the drawings show everything anew
  readonly chosenModule = signal(0); // an actuation module
  // The joints of an actuation module while a change of them is on its way.
  readonly newJoints = signal<{ module: number; joints: readonly number[] } | null>(null);
  readonly changes: DraftChanges;
  readonly offer: AlgorithmOffer;
  readonly actions: ActionList;
  readonly view: DraftView;
  readonly mesh: OwnMesh; // before it is part of the draft
  readonly draft = computed(() => this.page.state.draft.value);
  readonly objects = computed(() => this.draft.value?.world.objects ?? []);
  // The only object that is chosen; null: none, or several.
  readonly chosen = computed(() => (this.chosenObjects.value.length === 1 ? (this.chosenObjects.value[0] as number) : null));
  readonly chosenObject = computed(() => {
    const chosen = this.chosen.value;
    return chosen === null ? null : (this.objects.value[chosen] ?? null);
  });
  readonly search: SearchHost;
  // Text for the table of joints, until the table takes it.
  readonly jointText = signal<string | null>(null);

  private asksForWanted = false; // whether a draft may be lost, before the wanted scenario is opened

  constructor(readonly page: MakeStores) {
    this.changes = new DraftChanges(page, () => (this.newJoints.value = null));
    this.offer = new AlgorithmOffer(page, {
      start: async (file) => {
        if (await this.open(file)) await this.simulate();
      },
      open: async (file) => void (await this.open(file)),
      restore: () => this.restore(),
    });
    this.actions = new ActionList(page.actions, (action) => action.group === 'Page' || action.group === 'Robot');
    this.view = new DraftView(page.state, this.actions, () => page.startSceneWorker(), {
      joints: this.chosenJoints,
      objects: computed(() => this.objects.value.filter((_, number) => this.isChosen(number))),
      choose: (joint, object, adds) => this.chooseInView(joint, object, adds),
    });
    this.search = {
      page,
      draft: this.draft,
      draftRobot: this.view.state.robot,
      isSearchShown: computed(() => page.shownPage.value === 'make' && this.part.value === 'search' && page.state.isConnected.value),
      chosenSearch: signal<string | null>(null),
      chosenSweep: signal<string | null>(null),
      motion: this.view.wantedMotion,
      obstacle: () => this.obstacle(),
      setValues: (words, label) => this.changes.change('behaviour.values', { words, label }),
    };
    this.mesh = new OwnMesh({
      operations: page.operations,
      obstacle: () => this.obstacle(),
      addObject: (words) => this.addInFront((place) => this.changes.change('world.add_mesh', { ...words, ...place })),
      makeModule: (words) => this.changes.change('robot.own_module', words),
    });
    effect(() => this.openWanted());
    const canChange = () => this.obstacle() === null && this.draft.value !== null;
    const hasChosen = () => this.chosenObjects.value.length > 0 && this.chosenObjects.value.every((number) => this.objects.value[number]?.editable === true);
    const isRobot = () => this.part.value === 'robot';
    const hasOneJoint = () => this.chosenJoints.value.length === 1;
    // Text that is chosen in the page is copied by the browser.
    const canCopy = () => (isRobot() ? this.draft.value !== null : hasChosen()) && (document.getSelection()?.isCollapsed ?? true);
    this.actions.add(
      { id: 'draft_new', title: 'New: a robot, its gait and its world', group: 'Make', keys: ['N'], run: () => this.toggle('new') },
      { id: 'draft_undo', title: 'Undo the last change of the files', group: 'Make', keys: ['Ctrl+Z'], isEnabled: () => canChange() && this.draft.value?.undo !== null, run: () => void this.travel('draft.undo') },
      { id: 'draft_redo', title: 'Redo', group: 'Make', keys: ['Ctrl+Y', 'Ctrl+Shift+Z'], isEnabled: () => canChange() && this.draft.value?.redo !== null, run: () => void this.travel('draft.redo') },
      { id: 'draft_open', title: 'Open: show the scenarios', group: 'Make', keys: ['Ctrl+O'], isGlobal: true, run: () => this.toggle('open') },
      { id: 'draft_save', title: 'Save: show the changes of the files', group: 'Make', keys: ['Ctrl+S'], isGlobal: true, isEnabled: () => !hasEditorFocus(), run: () => this.toggle('save') },
      { id: 'draft_simulate', title: 'Simulate the draft on the page Live', group: 'Make', keys: ['Ctrl+Enter'], isGlobal: true, isEnabled: canChange, obstacle: () => this.obstacle(), run: () => void this.simulate() },
      { id: 'delete_object', title: 'Delete the chosen objects, or the joint', group: 'Make', keys: ['Delete', 'Backspace'], isEnabled: () => canChange() && (isRobot() ? hasOneJoint() : hasChosen()), run: () => void (isRobot() ? this.removeJoint() : this.remove()) },
      { id: 'joint_table', title: 'Table of joints: copy and paste', group: 'Make', keys: ['T'], isEnabled: () => this.draft.value !== null, run: () => this.toggleJointTable() },
      { id: 'duplicate_object', title: 'Duplicate the chosen objects, or the joint', group: 'Make', keys: ['Ctrl+D'], isEnabled: () => canChange() && (isRobot() ? hasOneJoint() : hasChosen()), run: () => void (isRobot() ? this.duplicateJoint() : this.tellDuplicate()) },
      { id: 'copy_object', title: 'Copy the chosen objects, or the table of joints', group: 'Make', keys: ['Ctrl+C'], isEnabled: canCopy, run: () => void (isRobot() ? this.copyJoints() : this.copy()) },
      { id: 'cut_object', title: 'Cut the chosen objects', group: 'Make', keys: ['Ctrl+X'], isEnabled: () => canChange() && !isRobot() && hasChosen() && canCopy(), run: () => void this.cut() },
      // The browser gives the text of the clipboard with the event that the key becomes.
      { id: 'paste', title: 'Paste objects, or a table of joints', group: 'Make', keys: ['Ctrl+V'], isLeftToBrowser: true, isEnabled: canChange, run: () => void this.pasteFromClipboard() },
    );
    page.makeActions.value = this.actions;
    addFront({
      isOpen: () => page.shownPage.peek() === 'make' && this.panel.peek() !== 'none',
      close: () => (this.panel.value = 'none'),
    });
    // Other parts of the program may have written files meanwhile: Apply to file.
    effect(() => {
      if (page.shownPage.value === 'make' && page.state.isConnected.value) void page.operations.ask('draft.refresh', {}).catch(() => {});
    });
  }

  async travel(way: 'draft.undo' | 'draft.redo'): Promise<void> {
    await this.changes.settled();
    await this.page.operations.tell(way, {});
  }

  // Opens a panel below the bar, or closes it.
  toggle(panel: 'new' | 'open' | 'save' | 'algorithm'): void {
    this.newStep.value = 0;
    this.panel.value = this.panel.peek() === panel ? 'none' : panel;
  }

  // The reason why nothing can be changed; null: it can.
  obstacle(): string | null {
    const { state } = this.page;
    if (!state.isConnected.value) return 'No connection to the program.';
    return state.isHolder.value ? null : 'Take control first (C).';
  }

  // Opens a scenario of the gallery. Returns whether it is open. Algorithms that it lacks are offered to be built.
  async open(file: string): Promise<boolean> {
    this.offer.dismissed.value = null;
    const refusal = await this.changes.outcomeOf(this.page.operations.ask('draft.open', { file, ...this.discard() }));
    if (refusal !== null) {
      this.tellRefusal(refusal);
      return false;
    }
    this.forgetChoice();
    this.panel.value = 'none';
    return true;
  }

  // Makes the changes again that an earlier program did not save.
  async restore(): Promise<void> {
    this.offer.dismissed.value = null;
    const refusal = await this.changes.outcomeOf(this.page.operations.ask('draft.restore', {}));
    if (refusal !== null) this.tellRefusal(refusal);
  }

  // What is missing is in the offer to build it, which may come later than the refusal.
  private tellRefusal(refusal: string): void {
    if (!refusal.includes(': found unknown algorithm ')) this.page.state.addNotice('warning', refusal);
  }

  // Shows the source of an algorithm, at a place.
  async showAlgorithm(folder: string, place: { line: number; column: number } | null): Promise<void> {
    this.part.value = 'algorithm';
    this.panel.value = this.draft.peek() === null ? 'algorithm' : 'none';
    const app = algorithmApp(this);
    await app.open(folder);
    if (place !== null) app.place.value = { line: place.line, column: place.column };
  }

  // Opens what another part of the page wants. A draft that would be lost is asked about first; who closes the question gives up.
  private openWanted(): void {
    const file = this.page.wantedScenario.value;
    const mayBeOpened = file !== null && !this.wouldLose();
    if (mayBeOpened || (this.asksForWanted && this.panel.value === 'none')) {
      this.page.wantedScenario.value = null;
      this.asksForWanted = false;
      if (mayBeOpened) void untracked(() => this.open(file));
    } else if (file !== null && !this.asksForWanted) {
      this.asksForWanted = true;
      this.panel.value = 'open';
    }
  }

  // Takes parts of another scenario of the gallery.
  async take(file: string, parts: readonly ('robot' | 'actuation' | 'environment')[]): Promise<void> {
    const refusal = await this.changes.outcomeOf(this.page.operations.ask('draft.take', { file, parts }));
    if (refusal !== null) {
      this.page.state.addNotice('warning', refusal);
      return;
    }
    this.forgetChoice();
    this.panel.value = 'none';
  }

  // Whether a new draft would lose the changes of this one: those of a scenario with files are kept beside them.
  wouldLose(): boolean {
    const draft = this.draft.value;
    return draft !== null && !draft.has_file && draft.changed.length > 0 && !this.discards.value;
  }

  private discard(): { discard?: boolean } {
    return this.discards.peek() ? { discard: true } : {};
  }

  // Another scenario has other parts.
  private forgetChoice(): void {
    this.chosenObjects.value = [];
    this.chosenJoints.value = [];
    this.chosenModule.value = 0;
    this.discards.value = false;
    this.refit.value += 1;
  }

  // Requests another value of the run. Returns the reason if it was refused, else null.
  changeRun(words: Operations['draft.run']): Promise<string | null> {
    return refusalOf(this.page.operations.ask('draft.run', words));
  }

  // The joints that an actuation module moves, also while a change of them is on its way.
  jointsOf(module: number): readonly number[] {
    const coming = this.newJoints.value;
    return coming?.module === module ? coming.joints : (this.draft.value?.behaviour.modules[module]?.joints ?? []);
  }

  setJoints(module: number, joints: readonly number[], gesture: number): void {
    this.newJoints.value = { module, joints };
    this.changes.follow('behaviour.joints', { module, joints }, gesture);
  }

  // As changeRun(), with a notice if it was refused.
  async tellRun(words: Operations['draft.run']): Promise<void> {
    await this.page.operations.tell('draft.run', words);
  }

  // The present pose of an object, also while it is dragged.
  poseOf(number: number, object: WorldObject): Pose {
    return this.drag.value?.moved.get(number) ?? poseFromArray(object.pose);
  }

  beginDrag(): void {
    const draft = this.draft.peek();
    if (draft === null) return;
    const head = poseFromArray(draft.head);
    this.drag.value = { gesture: this.page.newGesture(), head, start: draft.world.start.position, moved: new Map() };
  }

  // Moves an object, with its group unless it is moved alone. The answer of the program corrects what is shown.
  dragObject(number: number, pose: Pose, isAlone: boolean): void {
    const drag = this.drag.peek();
    const object = this.objects.peek()[number];
    if (drag === null || object === undefined) return;
    const hasGroup = !isAlone && object.group_size > 1;
    const motion = compose(pose, invert(poseFromArray(object.pose)));
    const moved = new Map<number, Pose>([[number, pose]]);
    this.objects.peek().forEach((other, i) => {
      if (hasGroup && i !== number && other.group === object.group) moved.set(i, compose(motion, poseFromArray(other.pose)));
    });
    this.drag.value = { ...drag, moved };
    this.changes.follow('world.place', { object: number, pose: arrayOf(pose), group: hasGroup }, drag.gesture);
  }

  // Moves the start of the robot: its head comes to this place.
  dragStart([x, y, z]: Vector): void {
    const drag = this.drag.peek();
    const draft = this.draft.peek();
    if (drag === null || draft === null) return;
    const { position, orientation } = drag.head;
    this.drag.value = { ...drag, moved: new Map([[startOfRobot, { position: [x, y, z], orientation }]]) };
    const from = drag.start;
    const to: [number, number, number] = [from[0] + x - position[0], from[1] + y - position[1], from[2] + z - position[2]];
    this.changes.follow('world.start', { position: to, degrees: draft.world.start.degrees }, drag.gesture);
  }

  endDrag(): void {
    const drag = this.drag.peek();
    // What is shown stays until the draft of the last answer has come.
    this.changes.afterLastStep(() => {
      if (this.drag.peek()?.gesture === drag?.gesture) this.drag.value = null;
    });
  }

  // Turns an object to a heading, in degrees, where it is.
  turned(object: WorldObject, degrees: number): Pose {
    const pose = poseFromArray(object.pose);
    const by = ((degrees - headingOf(pose)) * Math.PI) / 180;
    return { position: pose.position, orientation: multiply(fromAxisAngle([0, 0, 1], by), pose.orientation) };
  }

  // Whether an object is chosen, or belongs to one that is.
  isChosen(number: number): boolean {
    const object = this.objects.value[number];
    return this.chosenObjects.value.some((chosen) => {
      const other = this.objects.value[chosen];
      return chosen === number || (object !== undefined && object.group_size > 1 && object.group === other?.group);
    });
  }

  // Chooses one object, or none. adds: the others stay chosen, and a chosen one is taken out again.
  chooseObject(number: number | null, adds = false): void {
    const chosen = this.chosenObjects.peek();
    if (number === null) {
      if (!adds) this.chosenObjects.value = [];
      return;
    }
    const group = this.objects.peek()[number]?.group ?? null;
    const others = chosen.filter((other) => other !== number && (group === null || this.objects.peek()[other]?.group !== group));
    this.chosenObjects.value = adds ? (others.length === chosen.length ? [...chosen, number] : others) : [number];
  }

  // Chooses what was clicked in the 3D view, and shows its part. The ground is the background.
  private chooseInView(joint: number | null, object: PlacedObject | null, adds: boolean): void {
    if (this.view.motion.peek() !== null) return; // somebody watches it
    const number = object === null ? -1 : this.objects.peek().findIndex(({ moves, index }) => moves === object.moves && index === object.index);
    const isGround = this.objects.peek()[number]?.shapes.some(({ size }) => Math.max(...size) > groundSize) ?? true;
    if (joint !== null) {
      this.part.value = 'robot';
      this.chosenObjects.value = [];
      this.chooseJoint(joint, adds);
    } else if (!isGround) {
      this.part.value = 'world';
      this.chosenJoints.value = [];
      this.chooseObject(number, adds);
    } else if (!adds) {
      this.chooseObject(null);
      this.chosenJoints.value = [];
    }
  }

  async remove(): Promise<void> {
    const objects = this.chosenObjects.peek();
    this.chosenObjects.value = [];
    await this.changes.tell('world.remove', { objects, group: true });
  }

  async duplicate(step: [number, number, number], count: number): Promise<string | null> {
    const objects = this.chosenObjects.peek();
    return objects.length === 0 ? null : this.changes.change('world.duplicate', { objects, group: true, step, count });
  }

  private async tellDuplicate(): Promise<void> {
    const refusal = await this.duplicate([...copyStep], 1);
    if (refusal !== null) this.page.state.addNotice('warning', refusal);
  }

  private async duplicateJoint(): Promise<void> {
    const joint = this.chosenJoints.peek()[0];
    if (joint !== undefined) await this.changes.tell('robot.duplicate', { joint });
  }

  // Puts the chosen objects on the clipboard. Returns whether they are there.
  async copy(): Promise<boolean> {
    const layout = this.draft.peek()?.layout ?? 0;
    const answer = await this.page.operations.tell('draft.copy', { layout, objects: this.chosenObjects.peek() });
    const text = (answer as { text: string } | null)?.text;
    return text !== undefined && this.toClipboard(text);
  }

  async cut(): Promise<void> {
    const objects = this.chosenObjects.peek();
    if ((await this.copy()) && this.chosenObjects.peek() === objects) await this.remove();
  }

  // The rows of the chosen joints, or of all, with titles.
  async copyJoints(): Promise<boolean> {
    const joints = this.draft.peek()?.robot.joints ?? [];
    const chosen = this.chosenJoints.peek();
    const rows = joints.filter((_, joint) => chosen.length === 0 || chosen.includes(joint)).reverse();
    return this.toClipboard(copyJoints(rows, { from: { row: 0, column: 0 }, to: { row: rows.length, column: jointColumns.length } }));
  }

  private async toClipboard(text: string): Promise<boolean> {
    try {
      await navigator.clipboard.writeText(text);
      return true;
    } catch {
      this.page.state.addNotice('warning', 'Nothing was copied: the browser does not let this page write to the clipboard.');
      return false;
    }
  }

  // A text of the clipboard: objects of a world, or in the part Robot a table of joints.
  async paste(text: string): Promise<void> {
    if (this.part.peek() === 'robot' && !text.trimStart().startsWith('<')) {
      this.jointText.value = text;
      this.panel.value = 'none';
      openDialog.value = 'joint_table';
      return;
    }
    const count = () => this.objects.peek().filter(({ editable }) => editable).length;
    const before = count();
    if (!(await this.changes.tell('world.paste', { text: text.slice(0, mostPasted), step: [...copyStep] }))) return;
    this.part.value = 'world';
    this.chosenObjects.value = [];
    for (let number = before; number < count(); number += 1) {
      if (!this.isChosen(number)) this.chooseObject(number, true);
    }
  }

  // For a button and a touch screen.
  async pasteFromClipboard(): Promise<void> {
    let text: string;
    try {
      text = await navigator.clipboard.readText();
    } catch {
      this.page.state.addNotice('warning', 'The browser does not let this page read the clipboard: press Ctrl + V.');
      return;
    }
    await this.paste(text);
  }

  // The outlines of the shapes in the world from above.
  private outlines(): Point[][] {
    const robot = this.page.state.draftRobot.peek();
    if (robot === null) return [];
    return this.objects
      .peek()
      .flatMap((object) => bodyOf(robot, object)?.shapes.map((shape) => outline('top', poseFromArray(object.pose), shape)) ?? []);
  }

  // Adds an item of the library in front of the robot, and chooses it. Returns the reason if it was refused.
  add(item: string, values: Record<string, number>): Promise<string | null> {
    return this.addInFront((place) => this.changes.change('world.add', { item, values, ...place }));
  }

  // What was dropped on the page: a module while the robot is shown, else an object of the world.
  dropMesh(files: readonly MeshFile[]): void {
    if (this.draft.peek() === null) return;
    if (this.part.peek() !== 'robot') this.part.value = 'world';
    void this.mesh.take(files, this.part.peek() === 'robot' ? 'module' : 'world');
  }

  // Adds an object in front of the robot, and chooses it. Returns the reason if it was refused.
  async addInFront(add: (place: { position: [number, number, number]; turn: number }) => Promise<string | null>): Promise<string | null> {
    const draft = this.draft.peek();
    if (draft === null) return null;
    const before = draft.world.objects.filter(({ editable }) => editable).length;
    const [x, y] = draft.head;
    const heading = ((draft.world.start.degrees[2] + 90) * Math.PI) / 180; // a robot lies along y
    const distance = freeDistance([x, y], heading, this.outlines());
    const round = (value: number) => Math.round(value * 1000) / 1000;
    const position: [number, number, number] = [round(x + distance * Math.cos(heading)), round(y + distance * Math.sin(heading)), 0];
    const refusal = await add({ position, turn: draft.world.start.degrees[2] });
    if (refusal === null) this.chooseObject(before);
    return refusal;
  }

  private toggleJointTable(): void {
    this.part.value = 'robot';
    this.panel.value = 'none';
    toggleDialog('joint_table');
  }

  // Chooses one joint, or adds it to those that are chosen; a chosen one is taken out again.
  chooseJoint(joint: number, adds: boolean): void {
    const chosen = this.chosenJoints.peek();
    const others = chosen.filter((other) => other !== joint);
    this.chosenJoints.value = adds ? (others.length === chosen.length ? [...chosen, joint] : others) : [joint];
  }

  // Moves a joint, with its link, to the place of another one. Returns whether that was possible.
  async moveJoint(joint: number, to: number): Promise<boolean> {
    const isDone = to !== joint && (await this.changes.tell('robot.move', { joint, to }));
    if (isDone) this.chosenJoints.value = [to];
    return isDone;
  }

  // Sets values of joints as one change, with the joints that are missing. Returns the reason if it was refused, else null.
  async setJointTable({ joints, missing }: JointPaste): Promise<string | null> {
    const count = (this.draft.peek()?.robot.joints.length ?? 0) + missing;
    return this.changes.change('robot.table', { joints, ...(missing > 0 ? { count } : {}) });
  }

  // Removes the chosen joint with its link.
  async removeJoint(): Promise<void> {
    const joint = this.chosenJoints.peek()[0];
    if (joint === undefined) return;
    this.chosenJoints.value = [];
    await this.changes.tell('robot.remove', { joint });
  }

  // Makes the draft a new scenario. Of several calls in a row the newest counts. answered: with the reason of a refusal,
  // or null.
  makeNew(words: NewScenario, answered: (refusal: string | null) => void): void {
    this.changes.send(async () => {
      const refusal = await this.changes.outcomeOf(this.page.operations.ask('draft.new', { ...words, ...this.discard() }));
      if (refusal === null) this.forgetChoice();
      answered(refusal);
    });
  }

  // Writes a new scenario into a new folder, and starts it on the page Live. Returns the reason of a refusal, or null.
  async createNew(words: NewScenario, folder: string): Promise<string | null> {
    const { operations } = this.page;
    await this.changes.settled(); // a draft on its way, without this name, would come after it
    try {
      await operations.ask('draft.new', { ...words, ...this.discard() });
      await operations.ask('draft.save_as', { folder });
      this.panel.value = 'none';
      if (this.page.state.robot.value?.kind !== 'bus') {
        await operations.ask('load_draft', {});
        this.page.shownPage.value = 'live';
        await operations.ask('run', {});
      }
      return null;
    } catch (error) {
      return (error as Error).message;
    }
  }

  async simulate(): Promise<void> {
    await this.changes.settled();
    if ((await this.page.operations.tell('load_draft', {})) !== null) this.page.shownPage.value = 'live';
  }
}

// An editor of sources saves its own file.
function hasEditorFocus(): boolean {
  return document.activeElement?.closest('.code') != null;
}

// What the Save button can do with a draft.
export function saveObstacle(draft: DraftDocument | null): string | null {
  if (draft === null) return 'There is no scenario.';
  if (!draft.has_file) return 'This scenario has no files yet: save it as a new folder.';
  if (draft.is_shipped) return 'These files ship with Proleg and stay as they are: save a copy.';
  return draft.changed.length === 0 ? 'The files are as they are here.' : null;
}
