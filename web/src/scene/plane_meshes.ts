import { DoubleSide, Mesh, MeshBasicMaterial, PlaneGeometry, Quaternion, Vector3, type Scene } from 'three';
import { unit } from '../model';
import type { PlaneMark } from './overlay';

/** Cutting planes as translucent squares of the scene. */
export class PlaneMeshes {
  marks: readonly PlaneMark[] = [];
  private meshes: Mesh<PlaneGeometry, MeshBasicMaterial>[] = [];

  constructor(private readonly scene: Scene) {}

  set(marks: readonly PlaneMark[]): void {
    for (const mesh of this.meshes) {
      mesh.geometry.dispose();
      mesh.material.dispose();
      mesh.removeFromParent();
    }
    this.marks = marks;
    this.meshes = marks.map(meshOf);
    for (const mesh of this.meshes) this.scene.add(mesh);
  }
}

function meshOf(mark: PlaneMark): Mesh<PlaneGeometry, MeshBasicMaterial> {
  const material = new MeshBasicMaterial({
    color: mark.color,
    transparent: true,
    opacity: mark.selected ? 0.34 : 0.16,
    side: DoubleSide,
    depthWrite: false,
  });
  const mesh = new Mesh(new PlaneGeometry(mark.size_mm, mark.size_mm), material);
  mesh.quaternion.copy(new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), new Vector3(...unit(mark.normal))));
  mesh.position.set(...mark.point);
  mesh.renderOrder = 3;
  return mesh;
}
