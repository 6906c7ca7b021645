// The 3D view: camera, light, ground, robot. It renders only when something changed.
import * as THREE from 'three';
import { JointDrag, type Ray } from '../geometry/joint_drag.js';
import { OrbitCamera } from '../geometry/orbit_camera.js';
import { poseFromArray, type Vector } from '../geometry/quaternion.js';
import type { RobotDocument } from '../wire/messages.js';
import { HeadPath } from './head_path.js';
import type { Detail } from './drawing_budget.js';
import { RobotModel } from './robot_model.js';
import { colours } from './scene_colours.js';
import type { DragWay, PlacedObject, ScenePose } from './scene_messages.js';

const fieldOfView = 40; // degrees, vertical
const gridCells = 60;
const gridPiece = 2; // cells
const farthestDrag = 5; // metres
const longRobot = 1.5; // metres; for longer robots the cells of the grid are larger

// A view that does not follow the robot, for a film.
export interface Shot {
  target: Vector; // metres
  azimuth: number; // radians, as of OrbitCamera
  elevation: number;
  distance: number; // metres
  ground: Ground;
  farthest: number; // metres from the camera to where everything has faded
}

// The lines of the ground.
export interface Ground {
  cell: number; // metres between two of them
  turn: number; // radians of their directions from the axes
}

function rayOf({ ray }: THREE.Raycaster): Ray {
  const { origin, direction } = ray;
  return { origin: [origin.x, origin.y, origin.z], direction: [direction.x, direction.y, direction.z] };
}

// Lines in two directions, in pieces: without a graphics processor Chromium leaves out a line that ends behind the camera.
function groundLines(cell: number, colour: THREE.Color): THREE.LineSegments {
  const ends: number[] = [];
  const half = gridCells / 2;
  for (let line = -half; line <= half; line += 1) {
    for (let from = -half; from < half; from += gridPiece) {
      const to = from + gridPiece;
      ends.push(line, from, 0, line, to, 0, from, line, 0, to, line, 0);
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(ends.map((cells) => cells * cell), 3));
  return new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: colour }));
}

export class RobotScene {
  isFollowing = true;
  private readonly renderer: THREE.WebGLRenderer;
  private readonly scene = new THREE.Scene();
  private readonly camera = new THREE.PerspectiveCamera(fieldOfView, 1, 0.01, 200);
  private readonly orbit = new OrbitCamera();
  private readonly frustum = new THREE.Frustum();
  private readonly viewMatrix = new THREE.Matrix4();
  private readonly sun = new THREE.DirectionalLight(0xffffff, 2.2);
  private readonly sky = new THREE.HemisphereLight(0xffffff, 0x8090a0, 1.3);
  private readonly axes = new THREE.AxesHelper(0.1);
  private grid: THREE.LineSegments | null = null;
  private path: HeadPath | null = null;
  private model: RobotModel | null = null;
  private ghost: RobotModel | null = null;
  private ghostPath: HeadPath | null = null;
  private pulled: { drag: JointDrag; sense: number } | null = null;
  private run = -1;
  private robotKey = '';
  private lastMove: number | null = null;
  private lit: { joints: readonly number[]; objects: readonly PlacedObject[] } = { joints: [], objects: [] };
  private hasWholePath = false;
  private width = 1;
  private height = 1;
  private ratio = 1; // device pixels of the display for each CSS pixel
  private farthest: number | null = null; // of a shot
  private ground: Ground = { cell: 0.1, turn: 0 };
  private readonly fog = new THREE.Fog(0, 1, 2);
  private isDirty = true;
  private grabbed: THREE.Vector3 | null = null; // place of the grabbed point of the robot when it was grabbed
  private lastOffset: Vector = [0, 0, 0];

  // Throws an Error without WebGL.
  constructor(
    canvas: OffscreenCanvas,
    private isDark: boolean,
    isSoftware: boolean,
    private detail: Detail,
  ) {
    // Smooth edges cost a processor as much as all the rest.
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: !isSoftware });
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = isSoftware ? THREE.BasicShadowMap : THREE.PCFShadowMap;
    this.camera.up.set(0, 0, 1);
    this.sun.castShadow = detail.hasShadows;
    this.sun.shadow.mapSize.set(1024, 1024);
    this.sun.shadow.bias = -0.0008;
    this.scene.add(this.sun, this.sun.target, this.sky, this.axes);
    this.scene.fog = this.fog;
    this.setTheme(isDark);
  }

  setSize(width: number, height: number, ratio: number): void {
    Object.assign(this, { width, height, ratio });
    this.camera.aspect = width / Math.max(1, height);
    this.camera.updateProjectionMatrix();
    this.resize();
  }

  setDetail(detail: Detail): void {
    this.detail = detail;
    this.sun.castShadow = detail.hasShadows;
    this.resize();
  }

  private resize(): void {
    this.renderer.setPixelRatio(Math.min(this.ratio, this.detail.ratio));
    this.renderer.setSize(this.width, this.height, false);
    this.isDirty = true;
  }

  setTheme(isDark: boolean): void {
    this.isDark = isDark;
    const colour = colours(isDark);
    this.scene.background = colour.background;
    this.fog.color = colour.background;
    this.model?.setTheme(isDark);
    this.ghost?.setTheme(isDark);
    this.path?.setColour(colour.path);
    this.ghostPath?.setColour(colour.ghost);
    this.makeGrid();
    this.isDirty = true;
  }

  setRobot(robot: RobotDocument): void {
    this.remove(this.model, this.path);
    this.hasWholePath = false;
    // The same robot in another world is seen from where the viewer was.
    const robotKey = JSON.stringify([robot.joints, robot.links]);
    const isSameRobot = robotKey === this.robotKey;
    this.robotKey = robotKey;
    this.model = new RobotModel(robot, this.isDark);
    this.model.highlight(this.lit.joints, this.lit.objects);
    this.path = new HeadPath(this.model.length / 200);
    this.path.setColour(colours(this.isDark).path);
    this.scene.add(this.model.group, this.path.line);
    this.setGhost(robot);
    const reach = this.model.length * 0.9 + 0.2;
    Object.assign(this.sun.shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: 0.1, far: 8 * reach });
    this.sun.shadow.camera.updateProjectionMatrix();
    this.ground = { cell: this.model.length > longRobot ? 0.5 : 0.1, turn: 0 };
    this.makeGrid();
    if (!isSameRobot) this.resetView();
  }

  // Sets the ghost, which is invisible until a pose contains it.
  setGhost(robot: RobotDocument): void {
    this.remove(this.ghost, this.ghostPath);
    this.ghost = new RobotModel(robot, this.isDark, true);
    this.ghost.group.visible = false;
    this.ghostPath = new HeadPath(this.ghost.length / 200);
    this.ghostPath.setColour(colours(this.isDark).ghost);
    this.scene.add(this.ghost.group, this.ghostPath.line);
    this.isDirty = true;
  }

  private remove(model: RobotModel | null, path: HeadPath | null): void {
    if (model !== null) {
      this.scene.remove(model.group);
      model.dispose();
    }
    if (path !== null) {
      this.scene.remove(path.line);
    }
  }

  setPose(pose: ScenePose): void {
    if (this.model === null || this.path === null) {
      return;
    }
    this.place(this.model, pose.head, pose.angles, pose.contacts);
    this.model.placeObjects(pose.objects ?? null);
    if (this.ghost !== null) {
      this.ghost.group.visible = pose.ghost !== null;
      if (pose.ghost !== null) this.place(this.ghost, pose.ghostHead ?? pose.head, pose.ghost, []);
    }
    if (!this.hasWholePath) {
      this.growPath(this.path, pose);
    }
    this.isDirty = true;
  }

  // The path of a recording, which does not grow.
  setPath(heads: Float64Array, isOfGhost: boolean): void {
    const [model, path] = isOfGhost ? [this.ghost, this.ghostPath] : [this.model, this.path];
    this.hasWholePath ||= !isOfGhost;
    path?.clear();
    for (let at = 0; model !== null && at + 7 <= heads.length; at += 7) {
      if (Number.isNaN(heads[at])) {
        path?.cut();
      } else {
        path?.add(model.headCentre(poseFromArray([...heads.subarray(at, at + 7)])));
      }
    }
    this.isDirty = true;
  }

  private place(model: RobotModel, head: Float64Array | null, angles: ArrayLike<number>, contacts: ArrayLike<number>): void {
    if (head === null) {
      model.rest(angles, contacts);
    } else {
      model.move(poseFromArray([...head]), angles, contacts);
    }
  }

  resetView(): void {
    const length = this.model?.length ?? 1;
    this.orbit.azimuth = -0.5;
    this.orbit.elevation = 0.42;
    this.orbit.distance = 0.25 + length * 1.15;
    this.setFollowing(true);
  }

  // Sets a view that stays until the next one.
  setShot({ target, azimuth, elevation, distance, ground, farthest }: Shot): void {
    Object.assign(this.orbit, { target, azimuth, elevation, distance });
    Object.assign(this, { ground, farthest });
    this.makeGrid();
    this.axes.visible = false;
    this.setFollowing(false);
  }

  // Metres from the first link to the last.
  get robotLength(): number {
    return this.model?.length ?? 1;
  }

  // The middle of the robot in its last pose.
  get robotCentre(): Vector {
    return this.model?.centre ?? [0, 0, 0];
  }

  setFollowing(isOn: boolean): void {
    this.isFollowing = isOn;
    this.isDirty = true;
  }

  turn(right: number, down: number): void {
    this.orbit.turn(right, down);
    this.isDirty = true;
  }

  // Moves the view and stops following, because otherwise the robot would pull the view back.
  pan(right: number, down: number): void {
    this.isFollowing = false;
    this.orbit.pan(right, down, this.height, (fieldOfView * Math.PI) / 180);
    this.isDirty = true;
  }

  zoom(factor: number): void {
    this.orbit.zoom(factor);
    this.isDirty = true;
  }

  highlight(joints: readonly number[], objects: readonly PlacedObject[]): void {
    this.lit = { joints, objects };
    this.model?.highlight(joints, objects);
    this.isDirty = true;
  }

  // The joint or the object at a point; x and y are those of the messages: -1 to 1.
  partAt(x: number, y: number): { joint: number | null; object: PlacedObject | null } {
    return this.model?.partAt(this.casterAt(x, y)) ?? { joint: null, object: null };
  }

  // The joint at a point; x and y are those of the messages: -1 to 1.
  jointAt(x: number, y: number): number | null {
    return this.model?.hit(this.casterAt(x, y))?.joint ?? null;
  }

  // Begins to turn the joint of the link at a point. Null if there is none that can be turned from this view.
  grabJoint(x: number, y: number): number | null {
    this.pulled = null;
    const caster = this.casterAt(x, y);
    const hit = this.model?.hit(caster) ?? null;
    if (this.model === null || hit === null) {
      return null;
    }
    const { anchor, axis } = this.model.axisOf(hit.joint);
    const drag = JointDrag.begin(rayOf(caster), hit.point, anchor, axis);
    if (drag === null) {
      return null;
    }
    this.pulled = { drag, sense: hit.sense };
    return hit.joint;
  }

  // Turns the grabbed joint. Returns its angle since the grab in radians.
  dragJoint(x: number, y: number): number {
    return this.pulled === null ? 0 : this.pulled.sense * this.pulled.drag.angleOf(rayOf(this.casterAt(x, y)));
  }

  // Grabs the robot. Returns whether there is a link at the point.
  grabRobot(x: number, y: number): boolean {
    const hit = this.model?.hit(this.casterAt(x, y)) ?? null;
    this.grabbed = hit === null ? null : new THREE.Vector3(...hit.point);
    return this.grabbed !== null;
  }

  // The way from the place where the robot was grabbed: to the pointer in the plane of the ground, or up and down. Null if
  // nothing is grabbed.
  dragRobot(x: number, y: number, way: DragWay): Vector | null {
    const from = this.grabbed;
    if (from === null) {
      return null;
    }
    if (way === 'none') {
      return this.lastOffset;
    }
    const isHeight = way === 'height';
    const [cameraX, cameraY] = this.orbit.position;
    const normal = isHeight ? new THREE.Vector3(cameraX - from.x, cameraY - from.y, 0).normalize() : new THREE.Vector3(0, 0, 1);
    const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(normal, from);
    const to = this.casterAt(x, y).ray.intersectPlane(plane, new THREE.Vector3());
    // Near the horizon the way has no bound.
    if (to === null || to.distanceTo(from) > farthestDrag) {
      return this.lastOffset;
    }
    this.lastOffset = isHeight ? [0, 0, to.z - from.z] : [to.x - from.x, to.y - from.y, 0];
    return this.lastOffset;
  }

  dropRobot(): void {
    this.grabbed = null;
    this.lastOffset = [0, 0, 0];
    this.isDirty = true;
  }

  private casterAt(x: number, y: number): THREE.Raycaster {
    const caster = new THREE.Raycaster();
    caster.setFromCamera(new THREE.Vector2(x, y), this.camera);
    return caster;
  }

  // The view as it is now.
  picture(): Promise<ImageBitmap> {
    this.isDirty = true;
    this.render();
    return createImageBitmap(this.renderer.domElement);
  }

  // Draws the view. Returns false if nothing has changed.
  render(): boolean {
    if (!this.isDirty) {
      return false;
    }
    this.isDirty = false;
    if (this.isFollowing && this.model !== null && this.grabbed === null) {
      this.orbit.target = this.model.centre;
    }
    const [x, y, z] = this.orbit.target;
    this.camera.position.set(...this.orbit.position);
    this.camera.lookAt(x, y, z);
    const reach = (this.model?.length ?? 1) * 0.9 + 0.2;
    this.sun.position.set(x + reach, y + reach * 0.8, z + 2.2 * reach);
    this.sun.target.position.set(x, y, z);
    // The grid goes with the view in whole cells, so it looks endless and still shows that the robot moves.
    const { cell, turn } = this.ground;
    const [cosine, sine] = [Math.cos(turn), Math.sin(turn)];
    const along = Math.round((x * cosine + y * sine) / cell) * cell;
    const across = Math.round((y * cosine - x * sine) / cell) * cell;
    const height = (this.model?.floorHeight ?? 0) + 0.0005;
    this.grid?.position.set(along * cosine - across * sine, along * sine + across * cosine, height);
    // The edge of the grid fades before it ends.
    this.fog.far = this.farthest ?? this.orbit.distance + cell * gridCells * 0.45;
    this.fog.near = this.farthest === null ? this.orbit.distance * 1.3 : this.farthest / 2;
    this.camera.updateMatrixWorld();
    this.viewMatrix.multiplyMatrices(this.camera.projectionMatrix, this.camera.matrixWorldInverse);
    // Behind the fog everything has the colour of the background.
    this.model?.showIn(this.frustum.setFromProjectionMatrix(this.viewMatrix), this.fog.far, this.camera.position);
    this.renderer.render(this.scene, this.camera);
    return true;
  }

  private growPath(path: HeadPath, pose: ScenePose): void {
    if (pose.run !== this.run) {
      this.run = pose.run;
      path.clear();
    }
    if (pose.lastMove !== null && pose.lastMove !== this.lastMove) {
      this.lastMove = pose.lastMove;
      path.cut();
    }
    if (pose.isLive && this.model !== null) {
      path.add(this.model.head);
    }
  }

  private makeGrid(): void {
    if (this.grid !== null) {
      this.scene.remove(this.grid);
      this.grid.geometry.dispose();
      (this.grid.material as THREE.Material).dispose();
    }
    const { grid, joint } = colours(this.isDark);
    // In a film the lines are thin, because it is drawn larger than it is shown, and are compressed.
    this.grid = groundLines(this.ground.cell, this.farthest === null ? grid : grid.clone().lerp(joint, 0.4));
    this.grid.rotation.z = this.ground.turn;
    this.scene.add(this.grid);
  }
}
