// The robot and its terrain as meshes: one for each kind of shape that moves, one for all shapes that do not.
import * as THREE from 'three';
import { ForwardKinematics } from '../geometry/forward_kinematics.js';
import { compose, fromAxisAngle, multiply, poseFromArray, rotate, type Pose, type Vector } from '../geometry/quaternion.js';
import type { Body, Joint, RobotDocument, Ruler, Shape } from '../wire/messages.js';
import { type DrawnSet, type Instance, InstanceSet } from './instance_set.js';
import { MergedSet } from './merged_set.js';
import { colours } from './scene_colours.js';
import type { PlacedObject } from './scene_messages.js';
import { geometryOf, primitives, scaleOf, unitGeometry } from './shapes.js';

function instancesOf(bodies: readonly Body[], isWanted: (shape: Shape) => boolean, areLinks: boolean): Instance[] {
  return bodies.flatMap((body, link) =>
    body.shapes
      .filter(isWanted)
      .map((shape) => {
        const local = poseFromArray(shape.pose);
        const pose = areLinks ? local : compose(poseFromArray(body.pose), local);
        return { link: areLinks ? link : -1, body: link, pose, scale: scaleOf(shape) };
      }),
  );
}

const white = new THREE.Color(1, 1, 1);

// Makes flat boxes, one for each segment of the rulers.
function rulerInstances(rulers: readonly Ruler[]): Instance[] {
  return rulers.flatMap(({ from, to, division, width }, number) => {
    const way: Vector = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
    const length = Math.hypot(...way);
    const orientation = fromYTo(way);
    return Array.from({ length: Math.ceil(length / division - 1e-9) }, (_, i): Instance => {
      const begin = i * division;
      const end = Math.min(begin + division, length);
      const middle = (begin + end) / 2 / length;
      return {
        link: -1 - number,
        body: number,
        pose: { position: [from[0] + way[0] * middle, from[1] + way[1] * middle, from[2] + way[2] * middle], orientation },
        scale: [width / 2, (end - begin) / 2, 0.001],
      };
    });
  });
}

// The ghost is drawn behind the robot where both are at the same place, so that the robot keeps its colours.
const ghostLook = {
  transparent: true,
  opacity: 0.38,
  depthWrite: false,
  polygonOffset: true,
  polygonOffsetFactor: 2,
  polygonOffsetUnits: 2,
};

// The first shape that a ray hits.
function firstHit(caster: THREE.Raycaster, sets: readonly DrawnSet[]): { set: DrawnSet; instance: Instance; point: Vector } | null {
  sets.forEach(({ mesh }) => mesh instanceof THREE.InstancedMesh && mesh.computeBoundingSphere()); // its instances may have moved
  const found = caster.intersectObjects(sets.map(({ mesh }) => mesh), false)[0];
  const set = sets.find(({ mesh }) => mesh === found?.object);
  const instance = found === undefined ? undefined : set?.instanceAt(found);
  if (found === undefined || set === undefined || instance === undefined) {
    return null;
  }
  const { x, y, z } = found.point;
  return { set, instance, point: [x, y, z] };
}

// A link that a ray hits, and the joint that a pull at it turns.
export interface Hit {
  joint: number;
  sense: 1 | -1; // sense of the joint's angle, when the link turns about the axis
  point: Vector;
}

export class RobotModel {
  readonly group = new THREE.Group();
  readonly length: number; // metres, from the first joint to the last, at least 0.1
  readonly floorHeight: number;
  // Centre of the links, and where the head is, after the last `move`.
  centre: Vector = [0, 0, 0];
  head: Vector = [0, 0, 0];
  private readonly kinematics: ForwardKinematics;
  private readonly links: InstanceSet[];
  private readonly terrain: DrawnSet[];
  private readonly still: MergedSet | null; // in `terrain`
  private readonly objects: InstanceSet[];
  private readonly rulers: InstanceSet;
  private readonly joints: InstanceSet;
  private readonly contacts: InstanceSet;
  private readonly centres: Vector[]; // centres of the links, in their frames
  private contactBits: ArrayLike<number> = [];
  private litJoints: readonly number[] = [];
  private litObjects: readonly PlacedObject[] = [];
  private displacements: Pose[] = [];
  private isDark: boolean;

  // A ghost is translucent, and has neither terrain nor marks of contacts.
  constructor(
    private readonly robot: RobotDocument,
    isDark: boolean,
    private readonly isGhost = false,
  ) {
    this.isDark = isDark;
    this.kinematics = new ForwardKinematics(robot);
    const material = new THREE.MeshLambertMaterial(isGhost ? ghostLook : {});
    const marks = new THREE.MeshBasicMaterial();
    const coloured = new THREE.MeshLambertMaterial({ ...(isGhost ? ghostLook : { vertexColors: true }), side: THREE.DoubleSide });
    const plain = new THREE.MeshLambertMaterial({ ...(isGhost ? ghostLook : {}), side: THREE.DoubleSide });
    const shapesOf = (bodies: readonly Body[], areLinks: boolean) =>
      primitives
        .map((kind) => ({ kind, instances: instancesOf(bodies, (shape) => shape.kind === kind, areLinks) }))
        .filter(({ instances }) => instances.length > 0);
    const makeShapes = (bodies: readonly Body[]) =>
      shapesOf(bodies, true).map(({ kind, instances }) => new InstanceSet(unitGeometry[kind](), instances, material));
    const makeMeshes = (bodies: readonly Body[], areLinks: boolean) =>
      (robot.meshes ?? [])
        .map((mesh, number) => ({ mesh, instances: instancesOf(bodies, (shape) => shape.mesh === number, areLinks) }))
        .filter(({ instances }) => instances.length > 0)
        .map(({ mesh, instances }) => {
          const isColoured = mesh.colours.length > 0;
          return new InstanceSet(geometryOf(mesh), instances, isColoured ? coloured : plain, isColoured);
        });
    this.links = [...makeShapes(robot.links), ...makeMeshes(robot.links, true)];
    const still = isGhost ? [] : shapesOf(robot.terrain, false).flatMap(({ kind, instances }) => instances.map((instance) => ({ ...instance, kind })));
    const surfaces = isGhost ? [] : makeMeshes(robot.terrain, false);
    this.still = still.length > 0 ? new MergedSet(still, new THREE.MeshLambertMaterial({ vertexColors: true })) : null;
    this.terrain = [...(this.still === null ? [] : [this.still]), ...surfaces];
    this.rulers = new InstanceSet(unitGeometry.box(), isGhost ? [] : rulerInstances(robot.rulers ?? []), marks);
    [...surfaces, this.rulers].forEach((set) => {
      set.place([]);
      set.mesh.castShadow = false;
    });
    this.objects = isGhost ? [] : [...makeShapes(robot.objects ?? []), ...makeMeshes(robot.objects ?? [], true)];
    this.centres = robot.links.map(centreOf);
    this.length = Math.max(0.1, this.chainLength(robot));
    const thickness = this.typicalThickness();
    this.joints = new InstanceSet(new THREE.CylinderGeometry(1, 1, 2, 20), this.jointInstances(robot, thickness), material);
    this.contacts = new InstanceSet(new THREE.BoxGeometry(2, 2, 2), isGhost ? [] : this.contactInstances(robot, thickness), marks);
    this.contacts.mesh.castShadow = false;
    this.floorHeight = floorHeight(robot);
    for (const set of this.all()) {
      set.mesh.castShadow &&= !isGhost;
      set.mesh.receiveShadow = !isGhost;
      this.group.add(set.mesh);
    }
    this.rest();
    this.placeObjects(null);
    this.paint();
  }

  private all(): DrawnSet[] {
    return [...this.links, ...this.terrain, ...this.objects, this.rulers, this.joints, this.contacts];
  }

  // `poses`: of each object that moves, x, y, z in metres, then the quaternion; null: where they were at the start.
  placeObjects(poses: ArrayLike<number> | null): void {
    const objects = this.robot.objects ?? [];
    const at = objects.map((object, i) =>
      poseFromArray(poses === null ? object.pose : Array.from({ length: 7 }, (_, k) => poses[7 * i + k] ?? 0)),
    );
    this.objects.forEach((set) => set.place(at));
  }

  move(head: Pose, angles: ArrayLike<number>, contactBits: ArrayLike<number>): void {
    this.displacements = this.kinematics.displacements(head, angles);
    const poses = this.kinematics.linkPoses(head, angles);
    for (const set of [...this.links, this.joints, this.contacts]) {
      set.place(poses);
    }
    const centres = poses.map((pose, i) => compose(pose, { position: this.centres[i] as Vector, orientation: [1, 0, 0, 0] }));
    const mean = (axis: 0 | 1 | 2) => centres.reduce((sum, { position }) => sum + position[axis], 0) / centres.length;
    this.centre = [mean(0), mean(1), mean(2)];
    this.head = this.headCentre(poses[0] as Pose);
    this.contactBits = contactBits;
    this.paintContacts();
  }

  // The middle of the head link for a pose of its frame.
  headCentre(head: Pose): Vector {
    return compose(head, { position: this.centres[0] as Vector, orientation: [1, 0, 0, 0] }).position;
  }

  // Places the robot until its first tick, and if its place is not known: its head is where it is if all of the robot lies
  // straight on the floor.
  rest(angles: ArrayLike<number> = [], contactBits: ArrayLike<number> = []): void {
    const head = poseFromArray((this.robot.links[0] as Body).pose);
    const [x, y, z] = head.position;
    const centres = this.restCentres(this.robot);
    const lowest = Math.min(...this.robot.links.map((link, i) => (centres[i] as Vector)[2] - halfExtent(link, [0, 0, 1])));
    this.move({ ...head, position: [x, y, z + this.floorHeight - lowest] }, angles, contactBits);
  }

  highlight(joints: readonly number[], objects: readonly PlacedObject[]): void {
    this.litJoints = joints;
    this.litObjects = objects;
    this.paint();
  }

  // As MergedSet.showIn() and cutAround(), around a place that is in view.
  showIn(frustum: THREE.Frustum, farthest: number, place: THREE.Vector3): void {
    // A power of two changes rarely while the view zooms.
    this.still?.cutAround(place, 2 ** Math.ceil(Math.log2(2 * farthest)));
    this.still?.showIn(frustum, farthest);
  }

  setTheme(isDark: boolean): void {
    this.isDark = isDark;
    this.paint();
  }

  // The link that is pointed at. It turns about the joint behind it; the last link turns about the joint before it.
  hit(caster: THREE.Raycaster): Hit | null {
    const found = firstHit(caster, [...this.links, this.joints]);
    if (found === null) {
      return null;
    }
    const last = this.joints.instances.length - 1;
    const { link } = found.instance;
    return { joint: Math.min(link, last), sense: link > last ? -1 : 1, point: found.point };
  }

  // The joint of the link that is pointed at, as hit() has it, or the object that is in front of it.
  partAt(caster: THREE.Raycaster): { joint: number | null; object: PlacedObject | null } {
    const found = firstHit(caster, [...this.links, this.joints, ...this.terrain, ...this.objects]);
    if (found === null) {
      return { joint: null, object: null };
    }
    const { set, instance } = found;
    const isMoving = this.objects.some((other) => other === set);
    if (this.terrain.includes(set) || isMoving) {
      return { joint: null, object: { moves: isMoving, index: instance.body } };
    }
    return { joint: Math.min(instance.link, this.joints.instances.length - 1), object: null };
  }

  // The present place of a joint's axis; `axis` has length 1.
  axisOf(index: number): { anchor: Vector; axis: Vector } {
    const joint = this.robot.joints[index] as Joint;
    const displacement = this.displacements[index] as Pose;
    const length = Math.hypot(...joint.axis) || 1;
    const axis: Vector = [joint.axis[0] / length, joint.axis[1] / length, joint.axis[2] / length];
    return {
      anchor: compose(displacement, { position: joint.anchor, orientation: [1, 0, 0, 0] }).position,
      axis: rotate(displacement.orientation, axis),
    };
  }

  dispose(): void {
    for (const set of this.all()) {
      set.dispose();
    }
  }

  private paint(): void {
    const colour = colours(this.isDark);
    if (this.isGhost) {
      [...this.links, this.joints].forEach((set) => set.paint(() => colour.ghost));
      return;
    }
    const isLit = (instance: Instance) => this.litJoints.includes(instance.link);
    const lit = (moves: boolean) => new Set(this.litObjects.filter((object) => object.moves === moves).map(({ index }) => index));
    const [litTerrain, litMoving] = [lit(false), lit(true)];
    this.links.forEach((set) =>
      set.paint((instance) => {
        const own = set.isColoured ? white : instance.link === 0 ? colour.head : colour.link;
        return isLit(instance) ? colour.highlight : own;
      }),
    );
    this.joints.paint((instance) => (isLit(instance) ? colour.highlight : colour.joint));
    this.terrain.forEach((set) =>
      set.paint(({ body }, i) => (litTerrain.has(body) ? colour.highlight : set.isColoured ? white : i === 0 ? colour.floor : colour.obstacle)), // the first shape is the ground
    );
    this.objects.forEach((set) => set.paint(({ body }) => (litMoving.has(body) ? colour.highlight : set.isColoured ? white : colour.object)));
    this.rulers.paint(({ link }, i) => {
      const first = this.rulers.instances.findIndex((other) => other.link === link);
      return (i - first) % 2 === 0 ? colour.rulerOdd : colour.rulerEven;
    });
    this.paintContacts();
  }

  private paintContacts(): void {
    const colour = colours(this.isDark);
    // Each link has two marks: the rear one first, in the order of the bits.
    this.contacts.paint((instance, i) =>
      (((this.contactBits[instance.link] ?? 0) >> (i % 2)) & 1) === 1 ? colour.contact : colour.noContact,
    );
  }

  private chainLength(robot: RobotDocument): number {
    const inRobot = this.restCentres(robot);
    const first = inRobot[0] as Vector;
    const last = inRobot.at(-1) as Vector;
    return Math.hypot(first[0] - last[0], first[1] - last[1], first[2] - last[2]);
  }

  private restCentres(robot: RobotDocument): Vector[] {
    return robot.links.map(
      (link, i) => compose(poseFromArray(link.pose), { position: this.centres[i] as Vector, orientation: [1, 0, 0, 0] }).position,
    );
  }

  // The half of the smallest side of a typical link.
  private typicalThickness(): number {
    // The thickest shape of each link counts, because others may be its feet.
    const sizes = this.robot.links
      .filter(({ shapes }) => shapes.length > 0)
      .map(({ shapes }) => Math.max(...shapes.map((shape) => Math.min(...(shape.kind === 'mesh' ? shape.size : scaleOf(shape))))))
      .sort((a, b) => a - b);
    return sizes[Math.floor(sizes.length / 2)] ?? 0.02;
  }

  // Makes cylinders along the axes of joints, each fixed to the link before the joint.
  private jointInstances(robot: RobotDocument, thickness: number): Instance[] {
    return robot.joints.map((joint, j) => {
      const link = poseFromArray((robot.links[j] as Body).pose);
      const inverse = invertRotation(link);
      const offset: Vector = [
        joint.anchor[0] - link.position[0],
        joint.anchor[1] - link.position[1],
        joint.anchor[2] - link.position[2],
      ];
      return {
        link: j,
        body: j,
        pose: { position: rotate(inverse, offset), orientation: multiply(inverse, fromYTo(joint.axis)) },
        scale: [thickness * 0.45, 1.04 * Math.max(thickness, halfExtent(robot.links[j] as Body, joint.axis)), thickness * 0.45],
      };
    });
  }

  // Makes marks for the rear and front touch sensors: below the link, towards its ends. The front is at the head.
  private contactInstances(robot: RobotDocument, thickness: number): Instance[] {
    const centres = this.restCentres(robot);
    const first = centres[0] as Vector;
    const last = centres.at(-1) as Vector;
    const length = Math.hypot(first[0] - last[0], first[1] - last[1], first[2] - last[2]) || 1;
    const forward = [0, 1, 2].map((axis) => ((first[axis] as number) - (last[axis] as number)) / length);
    const forwardVector: Vector = [forward[0] as number, forward[1] as number, forward[2] as number];
    const acrossVector: Vector = [-forwardVector[1], forwardVector[0], 0];
    const size = thickness * 0.26;
    return robot.links.flatMap((body, link) => {
      const inverse = invertRotation(poseFromArray(body.pose));
      const reach = halfExtent(body, forwardVector) * 0.65;
      const depth = halfExtent(body, [0, 0, 1]) * 0.8;
      const across = rotate(inverse, acrossVector);
      // The marks extend through the link, so that they are visible from both sides.
      const width = halfExtent(body, acrossVector) * 1.05;
      const along = (axis: 0 | 1 | 2) => size + Math.abs(across[axis]) * (width - size);
      return [-1, 1].map((side): Instance => {
        const offset = forwardVector.map((value, axis) => value * reach * side - (axis === 2 ? depth : 0));
        const centre = this.centres[link] as Vector;
        const moved = rotate(inverse, offset as unknown as Vector);
        return {
          link,
          body: link,
          pose: { position: [centre[0] + moved[0], centre[1] + moved[1], centre[2] + moved[2]], orientation: [1, 0, 0, 0] },
          scale: [along(0), along(1), along(2)],
        };
      });
    });
  }
}

// The extent of the link in metres from its middle along a unit vector of the robot's frame at angles 0.
function halfExtent(body: Body, direction: Vector): number {
  const reaches = body.shapes.map((shape) => {
    const { orientation } = compose(poseFromArray(body.pose), poseFromArray(shape.pose));
    const local = rotate([orientation[0], -orientation[1], -orientation[2], -orientation[3]], direction);
    const isBox = shape.kind === 'box' || shape.kind === 'mesh';
    const scale = isBox ? shape.size : scaleOf(shape);
    const reach = local.map((value, axis) => Math.abs(value) * (scale[axis] as number));
    return isBox ? reach.reduce((sum, value) => sum + value, 0) : Math.hypot(...reach);
  });
  return Math.max(0.001, ...reaches);
}

function invertRotation(pose: Pose): readonly [number, number, number, number] {
  const [w, x, y, z] = pose.orientation;
  return [w, -x, -y, -z];
}

// The rotation that turns the y axis into `axis`.
function fromYTo(axis: Vector): readonly [number, number, number, number] {
  const length = Math.hypot(...axis) || 1;
  const cosine = axis[1] / length;
  const turn: Vector = [axis[2], 0, -axis[0]];
  return Math.hypot(...turn) < 1e-9 ? [1, 0, 0, 0] : fromAxisAngle(turn, Math.acos(Math.max(-1, Math.min(1, cosine))));
}

function centreOf(body: Body): Vector {
  const positions = body.shapes.map((shape) => shape.pose);
  const mean = (axis: number) => positions.reduce((sum, pose) => sum + (pose[axis] as number), 0) / Math.max(1, positions.length);
  return [mean(0), mean(1), mean(2)];
}

// The height of the grid: the top of the widest box, else 0.
function floorHeight(robot: RobotDocument): number {
  let widest = 0;
  let height = 0;
  for (const body of robot.terrain) {
    for (const shape of body.shapes) {
      const width = shape.size[0] * shape.size[1];
      if (shape.kind === 'box' && width > widest) {
        widest = width;
        height = compose(poseFromArray(body.pose), poseFromArray(shape.pose)).position[2] + shape.size[2];
      }
    }
  }
  return height;
}
