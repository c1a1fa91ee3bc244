import { add, cross, dot, sub, type Grid, type Vec3 } from './frames';
import type { LabelEdit } from './labels';
import type { Surface } from './section';

// Labels painted on the tissue boundary, stored on the voxels of the scan (docs/tissue-mesh.md).

/** Distance within which a painted voxel sets a label: half a voxel diagonal, as in predict/boundary_labels [mm]. */
export const paintTolerance_mm = (grid: Grid): number => 0.5 * Math.hypot(...grid.spacing_mm);

/** L to millimeters along the voxel axes from the first voxel's center; this preserves distances. */
function gridMillimetres(grid: Grid): (x: number, y: number, z: number) => Vec3 {
  const [ox, oy, oz] = grid.origin_mm;
  const [a, b, c, d, e, f, g, h, i] = grid.direction;
  return (x, y, z) => {
    const [dx, dy, dz] = [x - ox, y - oy, z - oz];
    return [a * dx + d * dy + g * dz, b * dx + e * dy + h * dz, c * dx + f * dy + i * dz];
  };
}

const first = (mm: number, spacing_mm: number): number => Math.max(0, Math.ceil(mm / spacing_mm));
const last = (mm: number, spacing_mm: number, size: number): number => Math.min(size - 1, Math.floor(mm / spacing_mm));

/** Squared distance of a point from a triangle (Ericson, Real-Time Collision Detection, 5.1.5). */
export function triangleDistance2(p: Vec3, a: Vec3, b: Vec3, c: Vec3): number {
  const [ab, ac, ap] = [sub(b, a), sub(c, a), sub(p, a)];
  const to = (q: Vec3): number => dot(sub(p, q), sub(p, q));
  const along = (from: Vec3, edge: Vec3, fraction: number): number =>
    to(add(from, [fraction * edge[0], fraction * edge[1], fraction * edge[2]]));
  const [d1, d2] = [dot(ab, ap), dot(ac, ap)];
  if (d1 <= 0 && d2 <= 0) return to(a);
  const bp = sub(p, b);
  const [d3, d4] = [dot(ab, bp), dot(ac, bp)];
  if (d3 >= 0 && d4 <= d3) return to(b);
  const vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return along(a, ab, d1 / (d1 - d3));
  const cp = sub(p, c);
  const [d5, d6] = [dot(ab, cp), dot(ac, cp)];
  if (d6 >= 0 && d5 <= d6) return to(c);
  const vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return along(a, ac, d2 / (d2 - d6));
  const va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return along(b, sub(c, b), (d4 - d3) / (d4 - d3 + (d5 - d6)));
  const n = cross(ab, ac);
  const height = dot(n, ap);
  return (height * height) / dot(n, n);
}

/** Triangles of a surface, binned by the cube of their first corner, so that a stamp tests few of them. */
class TriangleCubes {
  private static readonly known = new WeakMap<Surface, TriangleCubes>();
  private readonly cubes = new Map<number, number[]>();
  private longest = 0;

  static of(surface: Surface): TriangleCubes {
    let cubes = TriangleCubes.known.get(surface);
    if (!cubes) TriangleCubes.known.set(surface, (cubes = new TriangleCubes(surface)));
    return cubes;
  }

  private constructor({ points, triangles }: Surface) {
    for (let t = 0; t < triangles.length; t += 3) {
      const a = 3 * triangles[t];
      for (const other of [3 * triangles[t + 1], 3 * triangles[t + 2]])
        for (let c = 0; c < 3; c++) this.longest = Math.max(this.longest, Math.abs(points[other + c] - points[a + c]));
      const key = keyOf(cubeOf(points[a]), cubeOf(points[a + 1]), cubeOf(points[a + 2]));
      const there = this.cubes.get(key);
      if (there) there.push(t);
      else this.cubes.set(key, [t]);
    }
  }

  /** Visits all triangles with a point within `distance` of p along each axis, and some others. */
  visit(p: Vec3, distance: number, onTriangle: (t: number) => void): void {
    const far = distance + this.longest;
    for (let k = cubeOf(p[2] - far); k <= cubeOf(p[2] + far); k++)
      for (let j = cubeOf(p[1] - far); j <= cubeOf(p[1] + far); j++)
        for (let i = cubeOf(p[0] - far); i <= cubeOf(p[0] + far); i++)
          this.cubes.get(keyOf(i, j, k))?.forEach(onTriangle);
  }
}

const CUBE_MM = 8;
const cubeOf = (mm: number): number => Math.floor(mm / CUBE_MM);
/** Key of a cube; 1024 cubes are 8 m, far more than a head. */
const keyOf = (i: number, j: number, k: number): number => i + 512 + 1024 * (j + 512 + 1024 * (k + 512));

/** One application of the brush to a surface. */
export interface BrushStamp {
  center_L: Vec3;
  /** Normal of the surface there; triangles that face away, such as the other side of a bone, are not painted. */
  normal: Vec3;
  radius_mm: number;
  /** Maximum distance of a painted voxel's center from the surface. */
  thickness_mm: number;
  /** 0 erases. */
  label: number;
}

/** Paints the voxels within the brush and near the surface, which is at its scanned pose; returns the changes. */
export function paintSurface(labels: Uint8Array, grid: Grid, surface: Surface, brushStamp: BrushStamp): LabelEdit {
  const { points, triangles } = surface;
  const { center_L, normal, radius_mm, thickness_mm, label } = brushStamp;
  const [nx, ny, nz] = grid.size;
  const [sx, sy, sz] = grid.spacing_mm;
  const reach = radius_mm + thickness_mm;
  const inGrid = gridMillimetres(grid);
  const center = inGrid(...center_L);
  const at: number[] = [];
  const before: number[] = [];
  const corner = (v: number): Vec3 => [points[3 * v], points[3 * v + 1], points[3 * v + 2]];
  TriangleCubes.of(surface).visit(center_L, reach, (t) => {
    let isNear = true;
    for (let axis = 0; axis < 3 && isNear; axis++) {
      const x = points[3 * triangles[t] + axis];
      const y = points[3 * triangles[t + 1] + axis];
      const z = points[3 * triangles[t + 2] + axis];
      isNear = Math.min(x, y, z) <= center_L[axis] + reach && Math.max(x, y, z) >= center_L[axis] - reach;
    }
    if (!isNear) return;
    const [p, q, r] = [corner(triangles[t]), corner(triangles[t + 1]), corner(triangles[t + 2])];
    if (dot(cross(sub(q, p), sub(r, p)), normal) <= 0) return;
    const [a, b, c] = [inGrid(...p), inGrid(...q), inGrid(...r)];
    const low = (axis: number): number => Math.min(a[axis], b[axis], c[axis]) - thickness_mm;
    const high = (axis: number): number => Math.max(a[axis], b[axis], c[axis]) + thickness_mm;
    const [i0, j0] = [first(low(0), sx), first(low(1), sy)];
    const [i1, j1, k1] = [last(high(0), sx, nx), last(high(1), sy, ny), last(high(2), sz, nz)];
    for (let k = first(low(2), sz); k <= k1; k++)
      for (let j = j0; j <= j1; j++)
        for (let i = i0; i <= i1; i++) {
          const n = i + nx * (j + ny * k);
          if (labels[n] === label) continue;
          const [dx, dy, dz] = [i * sx - center[0], j * sy - center[1], k * sz - center[2]];
          if (dx * dx + dy * dy + dz * dz > radius_mm * radius_mm) continue;
          if (triangleDistance2([i * sx, j * sy, k * sz], a, b, c) > thickness_mm * thickness_mm) continue;
          at.push(n);
          before.push(labels[n]);
          labels[n] = label;
        }
  });
  return { at: Uint32Array.from(at), before: Uint8Array.from(before), after: label };
}

/** Returns a function that finds the label of the nearest painted voxel, as predict/boundary_labels; 0 if none. */
export function paintReader(labels: Uint8Array, grid: Grid): (x: number, y: number, z: number) => number {
  const [nx, ny, nz] = grid.size;
  const [sx, sy, sz] = grid.spacing_mm;
  const reach = paintTolerance_mm(grid) * (1 + 1e-9);
  const inGrid = gridMillimetres(grid);
  return (x, y, z) => {
    const [px, py, pz] = inGrid(x, y, z);
    const [i0, i1, j0, j1] = [
      first(px - reach, sx),
      last(px + reach, sx, nx),
      first(py - reach, sy),
      last(py + reach, sy, ny),
    ];
    const k1 = last(pz + reach, sz, nz);
    let nearest = reach;
    let found = 0;
    for (let k = first(pz - reach, sz); k <= k1; k++)
      for (let j = j0; j <= j1; j++)
        for (let i = i0; i <= i1; i++) {
          const here = labels[i + nx * (j + ny * k)];
          if (here === 0) continue;
          const mm = Math.hypot(i * sx - px, j * sy - py, k * sz - pz);
          if (mm > nearest || (mm === nearest && found !== 0)) continue;
          nearest = mm;
          found = here;
        }
    return found;
  };
}

/** Updates the label of each vertex, or only of those within a ball. Returns whether any has changed. */
export function labelVertices(
  labels: Uint8Array,
  grid: Grid,
  points: Float32Array,
  into: Uint8Array,
  within?: { center: Vec3; radius_mm: number },
): boolean {
  const read = paintReader(labels, grid);
  const reach2 = within ? within.radius_mm ** 2 : 0;
  let hasChanged = false;
  for (let v = 0; v < into.length; v++) {
    const [x, y, z] = [points[3 * v], points[3 * v + 1], points[3 * v + 2]];
    if (within) {
      const [dx, dy, dz] = [x - within.center[0], y - within.center[1], z - within.center[2]];
      if (dx * dx + dy * dy + dz * dz > reach2) continue;
    }
    const label = read(x, y, z);
    hasChanged ||= label !== into[v];
    into[v] = label;
  }
  return hasChanged;
}

/** Adds the area by label to `into`; each corner has a third of its triangle [mm²]. */
export function areasByLabel({ points, triangles }: Surface, labelOf: Uint8Array, into: number[]): void {
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [triangles[t], triangles[t + 1], triangles[t + 2]];
    const found = [labelOf[a], labelOf[b], labelOf[c]];
    if (found[0] === 0 && found[1] === 0 && found[2] === 0) continue;
    const p = (v: number): Vec3 => [points[3 * v], points[3 * v + 1], points[3 * v + 2]];
    const area_mm2 = 0.5 * Math.hypot(...cross(sub(p(b), p(a)), sub(p(c), p(a))));
    for (const label of found) into[label] = (into[label] ?? 0) + area_mm2 / 3;
  }
}

/** First voxel and count along each axis. */
export type VoxelBox = readonly [number, number, number, number, number, number];

/** Bounding box of the paint; null if there is none. */
export function paintedBox(labels: Uint8Array, { size: [nx, ny, nz] }: Grid): VoxelBox | null {
  const low = [nx, ny, nz];
  const high = [-1, -1, -1];
  for (let n = 0; n < labels.length; n++) {
    if (labels[n] === 0) continue;
    const at = [n % nx, Math.floor(n / nx) % ny, Math.floor(n / (nx * ny))];
    for (let axis = 0; axis < 3; axis++) {
      low[axis] = Math.min(low[axis], at[axis]);
      high[axis] = Math.max(high[axis], at[axis]);
    }
  }
  if (high[0] < 0) return null;
  return [low[0], low[1], low[2], high[0] - low[0] + 1, high[1] - low[1] + 1, high[2] - low[2] + 1];
}

/** Visits each row of a box with its first index in the scan and in the box. */
function rowsOf(
  [i, j, k, ni, nj, nk]: VoxelBox,
  { size: [nx, ny] }: Grid,
  visit: (inScan: number, inBox: number) => void,
): void {
  for (let z = 0; z < nk; z++) for (let y = 0; y < nj; y++) visit(i + nx * (j + y + ny * (k + z)), ni * (y + nj * z));
}

export function bytesWithin(labels: Uint8Array, grid: Grid, box: VoxelBox): Uint8Array {
  const bytes = new Uint8Array(box[3] * box[4] * box[5]);
  rowsOf(box, grid, (inScan, inBox) => bytes.set(labels.subarray(inScan, inScan + box[3]), inBox));
  return bytes;
}

/** Labels of the whole scan: `bytes` within the box, 0 elsewhere. */
export function labelsOfBox(bytes: Uint8Array, grid: Grid, box: VoxelBox): Uint8Array {
  const labels = new Uint8Array(grid.size[0] * grid.size[1] * grid.size[2]);
  rowsOf(box, grid, (inScan, inBox) => labels.set(bytes.subarray(inBox, inBox + box[3]), inScan));
  return labels;
}
