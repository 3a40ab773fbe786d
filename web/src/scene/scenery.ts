/** The greenhouse: primitives of one kind share one instanced mesh, so that hundreds of leaves cost few draw calls. */

import {
  BoxGeometry,
  type BufferGeometry,
  Color,
  CylinderGeometry,
  Euler,
  Group,
  InstancedMesh,
  Matrix4,
  MeshLambertMaterial,
  Quaternion,
  SphereGeometry,
  Vector3,
} from "three";
import type { SceneryItem } from "../wire";
import { Moved, type Piece } from "./moved";
import { Wet } from "./wet";

/** Few segments: the whole view has to stay below 15,000 triangles. */
function unitGeometry(kind: SceneryItem["kind"]): BufferGeometry {
  switch (kind) {
    case "box":
      return new BoxGeometry(1, 1, 1);
    case "cylinder":
      return new CylinderGeometry(1, 1, 1, 6).rotateX(Math.PI / 2); // along z, as in URDF
    case "sphere":
      return new SphereGeometry(1, 7, 5);
  }
}

/** Scale of the unit geometry: box edges; cylinder radius and length; sphere radius. */
function scaleOf(item: SceneryItem, scale: Vector3): Vector3 {
  const [a = 1, b = a, c = b] = item.size_m;
  switch (item.kind) {
    case "box":
      return scale.set(a, b, c);
    case "cylinder":
      return scale.set(a, a, b);
    case "sphere":
      return scale.set(a, a, a);
  }
}

/** The rows beside the aisle (x runs along it) can be hidden one by one, to look at the robot through them. */
export interface Scenery {
  all: Group;
  left: Group;
  right: Group;
  moved: Moved;
  wet: Wet;
}

/** What stands at least this far beside the middle of the aisle belongs to a row. */
export const AISLE_HALF_WIDTH_M = 0.45;

export function buildScenery(items: readonly SceneryItem[]): Scenery {
  const pieces = new Map<string, Piece>();
  const left = batched(items.filter((item) => item.xyz_m[1] > AISLE_HALF_WIDTH_M), pieces);
  const right = batched(items.filter((item) => item.xyz_m[1] < -AISLE_HALF_WIDTH_M), pieces);
  const all = batched(items.filter((item) => Math.abs(item.xyz_m[1]) <= AISLE_HALF_WIDTH_M), pieces);
  const moved = new Moved(pieces);
  all.add(left, right, moved.group);
  return { all, left, right, moved, wet: new Wet(pieces) };
}

function batched(items: readonly SceneryItem[], pieces: Map<string, Piece>): Group {
  const batches = new Map<string, SceneryItem[]>();
  for (const item of items) {
    const key = `${item.kind} ${item.rgba[3]}`;
    const batch = batches.get(key);
    if (batch) batch.push(item);
    else batches.set(key, [item]);
  }
  const group = new Group();
  for (const batch of batches.values()) group.add(instanced(batch, pieces));
  return group;
}

function instanced(items: readonly SceneryItem[], pieces: Map<string, Piece>): InstancedMesh {
  const first = items[0];
  const alpha = first?.rgba[3] ?? 1;
  const material = new MeshLambertMaterial({ transparent: alpha < 1, opacity: alpha, depthWrite: alpha === 1 });
  const mesh = new InstancedMesh(unitGeometry(first?.kind ?? "box"), material, items.length);
  const matrix = new Matrix4();
  const place = new Vector3();
  const turn = new Quaternion();
  const scale = new Vector3();
  const euler = new Euler();
  const color = new Color();
  items.forEach((item, i) => {
    // URDF's roll, pitch, yaw turn about fixed axes: intrinsic z, y, x.
    turn.setFromEuler(euler.set(...item.rpy_rad, "ZYX"));
    matrix.compose(place.set(...item.xyz_m), turn, scaleOf(item, scale));
    mesh.setMatrixAt(i, matrix);
    pieces.set(item.name, { item, shared: mesh, index: i, home: matrix.clone() });
    const [r, g, b] = item.rgba;
    mesh.setColorAt(i, color.setRGB(r, g, b, "srgb"));
  });
  mesh.computeBoundingSphere();
  mesh.matrixAutoUpdate = false;
  return mesh;
}

export function disposeScenery(scenery: Scenery): void {
  scenery.moved.dispose();
  scenery.all.traverse((child) => {
    if (!(child instanceof InstancedMesh)) return;
    child.geometry.dispose();
    (child.material as MeshLambertMaterial).dispose();
    child.dispose();
  });
}
