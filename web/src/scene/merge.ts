/** One mesh per link and opacity instead of one per primitive: a tenth of the draw calls. */

import {
  BoxGeometry,
  BufferAttribute,
  type BufferGeometry,
  type Color,
  CylinderGeometry,
  Matrix4,
  Mesh,
  type MeshPhongMaterial,
  type Object3D,
  SphereGeometry,
} from "three";
import { mergeGeometries } from "three/examples/jsm/utils/BufferGeometryUtils.js";
import type { URDFLink } from "urdf-loader";

/** Unit shapes as the URDF loader scales and turns them; far coarser than its own, and finer where it is seen. */
const BOX = new BoxGeometry(1, 1, 1);
const SPHERE = new SphereGeometry(1, 10, 7);
const CYLINDERS = [6, 9, 14].map((segments) => new CylinderGeometry(1, 1, 1, segments));

function shape(mesh: Mesh): BufferGeometry {
  switch (mesh.geometry.type) {
    case "BoxGeometry":
      return BOX;
    case "SphereGeometry":
      return SPHERE;
    case "CylinderGeometry": {
      const radius_m = mesh.scale.x;
      return CYLINDERS[radius_m < 0.02 ? 0 : radius_m < 0.06 ? 1 : 2] ?? mesh.geometry;
    }
    default:
      return mesh.geometry;
  }
}

function colored(geometry: BufferGeometry, color: Color): BufferGeometry {
  const n = geometry.getAttribute("position").count;
  const colors = new Float32Array(3 * n);
  for (let i = 0; i < n; i++) color.toArray(colors, 3 * i);
  return geometry.setAttribute("color", new BufferAttribute(colors, 3));
}

/** Meshes of a link itself, not of what hangs on its joints. */
function visualsOf(link: Object3D, found: Mesh[] = []): Mesh[] {
  for (const child of link.children) {
    if ("isURDFJoint" in child || "isURDFCollider" in child) continue;
    if (child instanceof Mesh) found.push(child);
    visualsOf(child, found);
  }
  return found;
}

/** Replaces the visuals of a link by one mesh with vertex colours per opacity; returns the new meshes and opacities. */
export function mergeLink(link: URDFLink): { mesh: Mesh; opacity: number }[] {
  link.updateWorldMatrix(true, true);
  const toLink = link.matrixWorld.clone().invert();
  const byOpacity = new Map<number, BufferGeometry[]>();
  const visuals = visualsOf(link);
  for (const visual of visuals) {
    const material = visual.material as MeshPhongMaterial;
    const geometry = colored(shape(visual).clone(), material.color);
    geometry.applyMatrix4(new Matrix4().multiplyMatrices(toLink, visual.matrixWorld));
    const group = byOpacity.get(material.opacity);
    if (group) group.push(geometry);
    else byOpacity.set(material.opacity, [geometry]);
  }
  for (const child of [...link.children]) if ("isURDFVisual" in child) link.remove(child);
  return [...byOpacity].map(([opacity, geometries]) => {
    const mesh = new Mesh(mergeGeometries(geometries));
    for (const geometry of geometries) geometry.dispose();
    link.add(mesh);
    return { mesh, opacity };
  });
}
