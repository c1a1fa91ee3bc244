import { BufferAttribute, BufferGeometry, Group, Matrix4, Mesh, MeshLambertMaterial } from 'three';
import { linearOf, paint, vertexNormals, type DrawnSurface, type Mat4, type Rgb, type ScaleName } from '../model';

/** One surface in the 3D view: fine at rest, coarse during motion. */
export class Body {
  readonly group = new Group();
  // Always colors per vertex: another shader would take software rendering long to compile.
  private readonly material = new MeshLambertMaterial({ vertexColors: true });
  /** Writes depth only, before the color, so that a transparent surface does not show its own back. */
  private readonly depthOnly = new MeshLambertMaterial({ vertexColors: true, colorWrite: false });
  private readonly fine: Mesh;
  private readonly coarse: Mesh;
  private readonly fineDepth: Mesh;
  private readonly coarseDepth: Mesh;
  private opacity_ = 1;
  private isCoarse = false;
  shown = true;

  constructor(
    readonly surface: DrawnSurface,
    color: Rgb,
  ) {
    const fine = geometryOf(surface.points, surface.normals, surface.triangles);
    const { vertex, triangles } = surface.coarse;
    const coarse = geometryOf(gather(surface.points, vertex), gather(surface.normals, vertex), triangles);
    this.fine = new Mesh(fine, this.material);
    this.coarse = new Mesh(coarse, this.material);
    this.fineDepth = new Mesh(fine, this.depthOnly);
    this.coarseDepth = new Mesh(coarse, this.depthOnly);
    this.fineDepth.renderOrder = this.coarseDepth.renderOrder = 1;
    this.group.add(this.fine, this.coarse, this.fineDepth, this.coarseDepth);
    this.group.matrixAutoUpdate = false;
    this.setColor(color);
    this.update();
  }

  /** Sets one color; replaces the colors of values and labels. */
  setColor(color: Rgb): void {
    const [r, g, b] = linearOf(color);
    for (const array of this.colors()) for (let n = 0; n < array.length; n += 3) array.set([r, g, b], n);
  }

  /** The colors of both meshes, marked for upload. */
  private colors(): Float32Array[] {
    return [this.fine, this.coarse].map((mesh) => {
      const attribute = mesh.geometry.getAttribute('color') as BufferAttribute;
      attribute.needsUpdate = true;
      return attribute.array as Float32Array;
    });
  }

  get opacity(): number {
    return this.opacity_;
  }

  setOpacity(opacity: number): void {
    this.opacity_ = opacity;
    this.material.opacity = opacity;
    const clear = opacity < 1;
    if (this.material.transparent !== clear) {
      this.material.transparent = clear;
      this.material.needsUpdate = true;
    }
    this.fine.renderOrder = this.coarse.renderOrder = clear ? 2 : 0;
    this.update();
  }

  setCoarse(coarse: boolean): void {
    this.isCoarse = coarse;
    this.update();
  }

  setPose(X_LB: Mat4): void {
    this.group.matrix = new Matrix4().set(...(X_LB as Parameters<Matrix4['set']>));
    this.group.matrixWorldNeedsUpdate = true;
  }

  /** Colors each vertex by a value; `rest` is the color of values up to `from`. */
  setValues(values: Float32Array, scale: ScaleName, from: number, to: number, rest?: Rgb): void {
    const [fine, coarse] = this.colors();
    paint(values, scale, from, to, fine, rest);
    paint(
      Float32Array.from(this.surface.coarse.vertex, (v) => values[v]),
      scale,
      from,
      to,
      coarse,
      rest,
    );
  }

  /** Colors each vertex by its label; `palette`: linear RGB by label. */
  setLabels(labels: Uint8Array, palette: readonly Rgb[]): void {
    const [fine, coarse] = this.colors();
    const color = (into: Float32Array, n: number, label: number): void => {
      const rgb = palette[label] ?? palette[0];
      into[3 * n] = rgb[0];
      into[3 * n + 1] = rgb[1];
      into[3 * n + 2] = rgb[2];
    };
    for (let v = 0; v < labels.length; v++) color(fine, v, labels[v]);
    const { vertex } = this.surface.coarse;
    for (let n = 0; n < vertex.length; n++) color(coarse, n, labels[vertex[n]]);
  }

  /** Displaces each vertex by a vector (flat xyz, mm); null resets all. */
  setDisplacement(xyz: Float32Array | null, fraction = 1): void {
    const { points, triangles, normals, coarse } = this.surface;
    const moved = points.slice();
    if (xyz) for (let n = 0; n < moved.length; n++) moved[n] += fraction * xyz[n];
    const turned = xyz ? vertexNormals({ points: moved, triangles }) : normals;
    replace(this.fine.geometry, moved, turned);
    replace(this.coarse.geometry, gather(moved, coarse.vertex), gather(turned, coarse.vertex));
  }

  /** Current positions of the vertices. */
  get points(): Float32Array {
    return this.fine.geometry.getAttribute('position').array as Float32Array;
  }

  get coarseSurface(): { points: Float32Array; triangles: Uint32Array } {
    return {
      points: this.coarse.geometry.getAttribute('position').array as Float32Array,
      triangles: this.surface.coarse.triangles,
    };
  }

  /** Updates the visibility of the meshes. */
  update(): void {
    const visible = this.shown && this.opacity_ > 0;
    const clear = this.opacity_ < 1;
    this.fine.visible = visible && !this.isCoarse;
    this.coarse.visible = visible && this.isCoarse;
    this.fineDepth.visible = this.fine.visible && clear;
    this.coarseDepth.visible = this.coarse.visible && clear;
  }

  dispose(): void {
    this.fine.geometry.dispose();
    this.coarse.geometry.dispose();
    this.material.dispose();
    this.depthOnly.dispose();
    this.group.removeFromParent();
  }
}

function geometryOf(points: Float32Array, normals: Float32Array, triangles: Uint32Array): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(points, 3));
  geometry.setAttribute('normal', new BufferAttribute(normals, 3));
  geometry.setAttribute('color', new BufferAttribute(new Float32Array(points.length).fill(1), 3));
  geometry.setIndex(new BufferAttribute(triangles, 1));
  geometry.computeBoundingSphere();
  return geometry;
}

function gather(xyz: Float32Array, vertex: Uint32Array): Float32Array {
  const out = new Float32Array(3 * vertex.length);
  for (let n = 0; n < vertex.length; n++) out.set(xyz.subarray(3 * vertex[n], 3 * vertex[n] + 3), 3 * n);
  return out;
}

function replace(geometry: BufferGeometry, points: Float32Array, normals: Float32Array): void {
  geometry.setAttribute('position', new BufferAttribute(points, 3));
  geometry.setAttribute('normal', new BufferAttribute(normals, 3));
  geometry.computeBoundingSphere();
}
