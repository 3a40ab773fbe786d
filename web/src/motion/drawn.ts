/** What a motion shows: its robot, its volumes, its tool path with a mark where the tool is. */

import {
  BoxGeometry,
  type BufferGeometry,
  Color,
  CylinderGeometry,
  CatmullRomCurve3,
  Euler,
  Group,
  InstancedMesh,
  Matrix4,
  Mesh,
  MeshLambertMaterial,
  Quaternion,
  SphereGeometry,
  TubeGeometry,
  Vector3,
} from "three";
import URDFLoader, { type URDFRobot } from "urdf-loader";
import { mergeLink } from "../scene/merge";
import type { SceneryItem } from "../wire";
import type { Motion } from "./motion";

const PATH_SHARE = 0.0022;

export function buildRobot(motion: Motion): URDFRobot {
  const loader = new URDFLoader();
  loader.parseCollision = false;
  const robot = loader.parse(motion.urdf);
  for (const link of Object.values(robot.links)) {
    for (const { mesh, opacity } of mergeLink(link)) {
      mesh.material = new MeshLambertMaterial({ vertexColors: true, transparent: opacity < 1, opacity });
    }
  }
  robot.position.set(...motion.base_xyz_m);
  robot.rotation.copy(new Euler(...motion.base_rpy_rad, "ZYX"));
  return robot;
}

function unitGeometry(kind: SceneryItem["kind"]): BufferGeometry {
  if (kind === "box") return new BoxGeometry(1, 1, 1);
  if (kind === "sphere") return new SphereGeometry(1, 12, 8);
  return new CylinderGeometry(1, 1, 1, 28).rotateX(Math.PI / 2); // along z, as in URDF
}

function scaleOf(item: SceneryItem): Vector3 {
  const [a = 1, b = a, c = b] = item.size_m;
  if (item.kind === "box") return new Vector3(a, b, c);
  return item.kind === "cylinder" ? new Vector3(a, a, b) : new Vector3(a, a, a);
}

/** One instanced mesh for each kind and opacity. */
export function buildVolumes(items: readonly SceneryItem[]): Group {
  const group = new Group();
  const batches = new Map<string, SceneryItem[]>();
  for (const item of items) {
    const key = `${item.kind} ${item.rgba[3]}`;
    batches.set(key, [...(batches.get(key) ?? []), item]);
  }
  for (const batch of batches.values()) {
    const [first] = batch;
    if (!first) continue;
    const opacity = first.rgba[3];
    const material = new MeshLambertMaterial({ transparent: opacity < 1, opacity, depthWrite: opacity === 1 });
    const mesh = new InstancedMesh(unitGeometry(first.kind), material, batch.length);
    batch.forEach((item, i) => {
      const turn = new Quaternion().setFromEuler(new Euler(...item.rpy_rad, "ZYX"));
      mesh.setMatrixAt(i, new Matrix4().compose(new Vector3(...item.xyz_m), turn, scaleOf(item)));
      const [r, g, b] = item.rgba;
      mesh.setColorAt(i, new Color().setRGB(r, g, b, "srgb"));
    });
    group.add(mesh);
  }
  return group;
}

/** The path as a tube that can be seen at any distance; null when the tool stands still. */
export function buildPath(motion: Motion, size_m: number): Mesh | null {
  const radius_m = PATH_SHARE * size_m;
  const kept: Vector3[] = [];
  for (const p of motion.path) {
    const here = new Vector3(...p);
    const last = kept.at(-1);
    if (!last || last.distanceTo(here) > 2 * radius_m) kept.push(here);
  }
  if (kept.length < 2) return null;
  const curve = new CatmullRomCurve3(kept, false, "centripetal");
  const [r, g, b] = motion.path_rgba;
  const color = new Color().setRGB(r, g, b, "srgb");
  const tube = new TubeGeometry(curve, Math.min(2000, 2 * kept.length), radius_m, 6);
  return new Mesh(tube, new MeshLambertMaterial({ color, emissive: color, emissiveIntensity: 0.35 }));
}

export function pathLength_m(motion: Motion): number {
  let sum = 0;
  for (let i = 1; i < motion.path.length; i++) {
    const [a, b] = [motion.path[i - 1], motion.path[i]];
    if (a && b) sum += Math.hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
  }
  return sum;
}

export function disposeTree(group: Group | Mesh | URDFRobot): void {
  group.traverse((child) => {
    if (!(child instanceof Mesh)) return;
    child.geometry.dispose();
    for (const material of [child.material].flat()) material.dispose();
    if (child instanceof InstancedMesh) child.dispose();
  });
}
