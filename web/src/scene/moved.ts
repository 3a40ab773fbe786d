/** Scenery that is no longer where it grew: each piece leaves its row's shared mesh and becomes a mesh of its own. */

import { type BufferGeometry, Color, Group, type InstancedMesh, Matrix4, Mesh, MeshLambertMaterial, Quaternion, Vector3 } from "three";
import type { Pose, RobotWire, SceneryItem } from "../wire";

/** One primitive in the mesh it shares. home: where it grew, size included. */
export interface Piece {
  item: SceneryItem;
  shared: InstancedMesh;
  index: number;
  home: Matrix4;
}

const NOWHERE = new Matrix4().makeScale(0, 0, 0);
/** Differences the eye cannot see in this view. */
const STILL_M = 1e-3;
const STILL_TURN = 2e-3;

export class Moved {
  readonly group = new Group();
  private readonly meshes = new Map<string, Mesh>();
  private readonly materials = new Map<number, MeshLambertMaterial>();
  private readonly place = new Vector3();
  private readonly turn = new Quaternion();

  constructor(private readonly pieces: ReadonlyMap<string, Piece>) {}

  /** Takes the poses of a state; true when the picture changes. */
  set(moved: RobotWire["moved"]): boolean {
    let changed = false;
    for (const name in moved) {
      const pose = moved[name];
      const piece = this.pieces.get(name);
      if (!pose || !piece) continue;
      const mesh = this.meshes.get(name) ?? this.take(name, piece);
      changed = this.move(mesh, pose) || changed;
      if (mesh.visible) continue;
      mesh.visible = changed = true;
      show(piece, NOWHERE);
    }
    for (const [name, mesh] of this.meshes) {
      const piece = this.pieces.get(name);
      if (!mesh.visible || name in moved || !piece) continue;
      mesh.visible = false;
      changed = true;
      show(piece, piece.home);
    }
    return changed;
  }

  private take(name: string, piece: Piece): Mesh {
    const mesh = new Mesh(piece.shared.geometry as BufferGeometry, this.material(piece.item.rgba));
    mesh.scale.setFromMatrixScale(piece.home);
    mesh.visible = false;
    this.meshes.set(name, mesh);
    this.group.add(mesh);
    return mesh;
  }

  private material([r, g, b]: SceneryItem["rgba"]): MeshLambertMaterial {
    const color = new Color().setRGB(r, g, b, "srgb");
    let material = this.materials.get(color.getHex());
    if (!material) {
      material = new MeshLambertMaterial({ color });
      this.materials.set(color.getHex(), material);
    }
    return material;
  }

  private move(mesh: Mesh, [x, y, z, qx, qy, qz, qw]: Pose): boolean {
    this.place.set(x, y, z);
    this.turn.set(qx, qy, qz, qw).normalize();
    if (mesh.position.distanceTo(this.place) < STILL_M && mesh.quaternion.angleTo(this.turn) < STILL_TURN) return false;
    mesh.position.copy(this.place);
    mesh.quaternion.copy(this.turn);
    return true;
  }

  dispose(): void {
    for (const material of this.materials.values()) material.dispose();
  }
}

function show(piece: Piece, matrix: Matrix4): void {
  piece.shared.setMatrixAt(piece.index, matrix);
  piece.shared.instanceMatrix.needsUpdate = true;
}
