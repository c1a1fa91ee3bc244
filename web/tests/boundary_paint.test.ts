import { describe, expect, it } from 'vitest';
import {
  AppliedStrokes,
  areasByLabel,
  bytesWithin,
  indexToL,
  labelsOfBox,
  labelVertices,
  paintedBox,
  paintTolerance_mm,
  paintReader,
  paintSurface,
  triangleDistance2,
  type Grid,
  type Surface,
  type Vec3,
} from '../src/model';

/** Voxels that are neither cubes nor along the axes of L. */
const c = Math.cos(0.4);
const s = Math.sin(0.4);
const grid: Grid = {
  size: [30, 28, 24],
  spacing_mm: [1, 1, 1.5],
  origin_mm: [-12, -15, -9],
  direction: [c, -s, 0, s, c, 0, 0, 0, 1],
};
const count = 30 * 28 * 24;
const blank = (): Uint8Array => new Uint8Array(count);

/** Two sheets of 20 mm, `apart` mm from one another, that face away from each other along y. */
function sheets(apart: number): Surface {
  const points: number[] = [];
  const triangles: number[] = [];
  const side = 21;
  for (const sheet of [0, 1]) {
    const base = points.length / 3;
    for (let z = 0; z < side; z++) for (let x = 0; x < side; x++) points.push(x - 10, sheet * apart, z - 4);
    for (let z = 0; z + 1 < side; z++)
      for (let x = 0; x + 1 < side; x++) {
        const at = base + x + side * z;
        const quad = [at, at + 1, at + side + 1, at, at + side + 1, at + side];
        triangles.push(...(sheet === 0 ? quad : quad.map((_, n) => quad[n - (n % 3) + [0, 2, 1][n % 3]])));
      }
  }
  return { points: Float32Array.from(points), triangles: Uint32Array.from(triangles) };
}

const brushStamp = {
  center_L: [0, 0, 5] as Vec3,
  normal: [0, -1, 0] as Vec3,
  radius_mm: 4,
  thickness_mm: 1.2,
  label: 2,
};

describe('the brush on a surface', () => {
  it('paints only voxels within its ball and near triangles that face it', () => {
    const labels = blank();
    const edit = paintSurface(labels, grid, sheets(6), brushStamp);
    let painted = 0;
    for (let n = 0; n < count; n++) {
      const p = indexToL(grid, [n % 30, Math.floor(n / 30) % 28, Math.floor(n / 840)]);
      const inside = Math.hypot(p[0], p[1], p[2] - 5) <= 4 && Math.abs(p[1]) <= 1.2;
      expect(labels[n]).toBe(inside ? 2 : 0);
      painted += inside ? 1 : 0;
    }
    expect(painted).toBeGreaterThan(50);
    expect(edit.at.length).toBe(painted);
    expect(new Set(edit.at).size).toBe(painted);
  });

  it('sets the label of every vertex well inside, as the solver reads the file', () => {
    const labels = blank();
    const surface = sheets(6);
    const reach = paintTolerance_mm(grid);
    paintSurface(labels, grid, surface, { ...brushStamp, thickness_mm: 0.8 + reach });
    const of = new Uint8Array(surface.points.length / 3);
    labelVertices(labels, grid, surface.points, of);
    for (let v = 0; v < of.length; v++) {
      const [x, y, z] = surface.points.subarray(3 * v, 3 * v + 3);
      const far = Math.hypot(x, y, z - 5);
      if (far <= 4 - reach) expect(of[v]).toBe(2);
      if (far > 4 + reach) expect(of[v]).toBe(0);
    }
    const read = paintReader(labels, grid);
    // A node that lies off the surface, but no further than the plan's capture_mm.
    for (const y of [-0.8, 0.8]) expect(read(0, y, 5)).toBe(2);
    expect(read(0, 6, 5)).toBe(0);
  });

  it('finds the nearest voxel, and the first of equally near ones', () => {
    const plain: Grid = {
      size: [4, 4, 3],
      spacing_mm: [0.5, 0.5, 2],
      origin_mm: [10, 20, 30],
      direction: [1, 0, 0, 0, 1, 0, 0, 0, 1],
    };
    const labels = new Uint8Array(48);
    labels[1 + 4 * (1 + 4)] = 1;
    labels[3 + 4 * (1 + 4)] = 2;
    const read = paintReader(labels, plain);
    const reach = paintTolerance_mm(plain);
    expect(read(10.5, 20.5, 32)).toBe(1);
    expect(read(10.95, 20.5, 32)).toBe(1);
    expect(read(11.05, 20.5, 32)).toBe(2);
    expect(read(11, 20.5, 32)).toBe(1);
    expect(read(10.5, 20.5, 32 - reach + 1e-6)).toBe(1);
    expect(read(10.5, 20.5, 32 - reach - 1e-6)).toBe(0);
    expect(read(11.5 + reach - 1e-6, 20.5, 32)).toBe(2);
  });

  it('erases, and is undone', () => {
    const labels = blank();
    const strokes = new AppliedStrokes();
    const first = paintSurface(labels, grid, sheets(6), brushStamp);
    const painted = labels.slice();
    const second = paintSurface(labels, grid, sheets(6), { ...brushStamp, radius_mm: 2, label: 0 });
    const erased = labels.slice();
    expect(second.at.length).toBeGreaterThan(5);
    strokes.setApplied([first, second]);
    expect(strokes.apply(labels, [first])).toBe(true);
    expect(labels).toEqual(painted);
    strokes.apply(labels, []);
    expect(labels).toEqual(blank());
    strokes.apply(labels, [first, second]);
    expect(labels).toEqual(erased);
  });

  it('measures the painted area', () => {
    const surface = sheets(6);
    const of = new Uint8Array(surface.points.length / 3).fill(1, 0, 441);
    const areas: number[] = [];
    areasByLabel(surface, of, areas);
    expect(areas[1]).toBeCloseTo(400, 6);
  });

  it('is sent as its bounding box, and read again', () => {
    const labels = blank();
    expect(paintedBox(labels, grid)).toBeNull();
    paintSurface(labels, grid, sheets(6), brushStamp);
    const box = paintedBox(labels, grid)!;
    const bytes = bytesWithin(labels, grid, box);
    expect(bytes.length).toBeLessThan(count / 10);
    expect(labelsOfBox(bytes, grid, box)).toEqual(labels);
  });
});

describe('the distance of a point from a triangle', () => {
  it('equals that of samples', () => {
    const [a, b, d]: Vec3[] = [
      [0, 0, 0],
      [3, 0, 1],
      [1, 2, -1],
    ];
    for (let n = 0; n < 200; n++) {
      const p: Vec3 = [Math.sin(n) * 4, Math.sin(1.7 * n) * 4, Math.sin(2.3 * n) * 4];
      let min = Infinity;
      for (let u = 0; u <= 60; u++)
        for (let v = 0; u + v <= 60; v++) {
          const q = [0, 1, 2].map((k) => a[k] + (u / 60) * (b[k] - a[k]) + (v / 60) * (d[k] - a[k]));
          min = Math.min(min, Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
        }
      const found = Math.sqrt(triangleDistance2(p, a, b, d));
      expect(found).toBeLessThanOrEqual(min + 1e-9);
      expect(found).toBeGreaterThan(min - 0.06);
    }
  });
});
